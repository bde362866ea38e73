// SPDX-License-Identifier: Apache-2.0
#include "hil/report/html_text.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace kerfbench::report {

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = (group << 8U) | (k < have ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += k <= have ? kDigits[(group >> (18U - 6U * k)) & 63U] : '=';
    }
  }
  return out;
}

std::string checkNumber(const inspect::Check& check, double value) {
  if (std::isnan(value)) return "no number";
  if (check.unit == "mm") return fmt::format("{:.4f} mm", value);
  if (check.unit == "us") return fmt::format("{:.2f} µs", value);
  if (check.unit == "ms") return fmt::format("{:.2f} ms", value);
  if (check.unit == "share") return fmt::format("{:.2f} %", 100.0 * value);
  return check.unit.empty() ? fmt::format("{:.2f}", value) : fmt::format("{:.4g} {}", value, check.unit);
}

std::size_t limitBin(double offset_mm, double limit_mm) {
  return static_cast<std::size_t>(std::clamp(std::floor(4.0 * std::abs(offset_mm) / limit_mm), 0.0, 4.0));
}

std::string limitLegend(double limit_mm) {
  const double quarter_um = 250.0 * limit_mm;
  std::string html;
  for (std::size_t bin = 0; bin < kLimitBins; ++bin) {
    html +=
        bin + 1 < kLimitBins
            ? fmt::format("<span class=key><i class=k{}></i>{:.3g}–{:.3g} µm</span>", bin,
                          static_cast<double>(bin) * quarter_um, static_cast<double>(bin + 1) * quarter_um)
            : fmt::format("<span class=key><i class=k{}></i>over {:.3g} µm</span>", bin, 4.0 * quarter_um);
  }
  return html;
}

std::string htmlRow(std::string_view key, const std::string& value, bool code) {
  if (value.empty()) return {};
  const std::string text = code ? "<code>" + escapeHtml(value) + "</code>" : escapeHtml(value);
  return fmt::format("<tr><th>{}<td>{}</tr>", escapeHtml(key), text);
}

std::string htmlFacts(const std::vector<std::pair<std::string_view, std::string>>& facts) {
  std::string html;
  for (const auto& [key, value] : facts) {
    if (!value.empty())
      html += fmt::format("{}{} <b>{}</b>", html.empty() ? "" : " · ", escapeHtml(key), escapeHtml(value));
  }
  return html;
}

std::string_view verdictClass(inspect::Verdict verdict) {
  switch (verdict) {
    case inspect::Verdict::kPass:
      return "pass";
    case inspect::Verdict::kFail:
      return "fail";
    case inspect::Verdict::kNotProven:
      return "notproven";
    case inspect::Verdict::kInvalid:
      break;
  }
  return "invalid";
}

std::string stopSentence(const inspect::InspectionResult& result) {
  for (const inspect::Check& check : result.checks)
    if (check.name == "finish" && check.verdict == inspect::Verdict::kFail) return check.explanation;
  return {};
}

std::string sentenceOfVerdict(const RunReport& report) {
  const inspect::InspectionResult& result = report.result;
  const std::string stop = stopSentence(result);
  std::string names;
  for (const inspect::Check& c : result.checks) {
    if (c.verdict == result.verdict) names += (names.empty() ? "" : ", ") + c.name;
  }
  switch (result.verdict) {
    case inspect::Verdict::kPass:
      if (report.provoked)
        return fmt::format(
            "The controller stopped the job safely: all {} checks are proven good. The job was to be "
            "stopped, so "
            "no "
            "camera looked at the cut.",
            result.checks.size());
      if (const std::string but = reservationsLine(report); !but.empty()) {
        return fmt::format(
            "All {} checks that were judged are proven good, measurement uncertainty included; but mind: {}.",
            result.checks.size(), but);
      }
      return fmt::format("This run is good: all {} checks are proven good, measurement uncertainty included.",
                         result.checks.size());
    case inspect::Verdict::kFail:
      return fmt::format("This run is bad: proven by {}.{}", names, stop.empty() ? "" : " " + stop);
    case inspect::Verdict::kNotProven:
      return fmt::format(
          "Neither good nor bad is proven: inside the guard band of {}. A finer measurement or a better "
          "release is needed.",
          names);
    case inspect::Verdict::kInvalid:
      break;
  }
  if (!result.problems.empty()) {
    return fmt::format(
        "The evidence cannot be trusted: {}{}", result.problems.front(),
        result.problems.size() > 1 ? fmt::format(" And {} more.", result.problems.size() - 1) : "");
  }
  return names.empty() ? "Nothing was checked." : fmt::format("Could not be measured: {}.", names);
}

std::string verdictSentence(const RunReport& report) {
  const std::string verdict = sentenceOfVerdict(report);
  const std::string cause = likelyCauseOf(report);
  return cause.empty() ? verdict : cause + " " + verdict;
}

std::string gaugeSvg(const inspect::Check& check) {
  if (!std::isfinite(check.value) || check.limit == 0.0 || !std::isfinite(check.u)) return {};
  // Everything as a share of what is allowed: 0 is ideal, 1 is the limit. A lower limit is one on a share
  // of 1.
  const double allowed = check.upper ? check.limit : 1.0 - check.limit;
  if (!(allowed > 0.0)) return {};
  const double share = (check.upper ? check.value : 1.0 - check.value) / allowed;
  const double half_u = check.u / allowed;
  const double half_w = check.guard / allowed;
  constexpr double kGaugeWidth = 120.0;
  constexpr double kFull = 1.6;
  const auto x = [&](double s) { return kGaugeWidth * std::clamp(s, 0.0, kFull) / kFull; };
  return fmt::format(
      "<svg class=gauge viewBox='-3 0 126 16' role=img aria-label='{:.0f} % of the limit'>"
      "<rect class=ok x=0 y=5 width={:.1f} height=6 /><rect class=band x={:.1f} y=5 width={:.1f} height=6 />"
      "<rect class=bad x={:.1f} y=5 width={:.1f} height=6 /><line class=lim x1={:.1f} x2={:.1f} y1=2 y2=14 />"
      "<line class=unc x1={:.1f} x2={:.1f} y1=8 y2=8 /><circle class=val cx={:.1f} cy=8 r=3 /></svg>",
      100.0 * share, x(1.0 - half_w), x(1.0 - half_w), x(1.0 + half_w) - x(1.0 - half_w), x(1.0 + half_w),
      kGaugeWidth - x(1.0 + half_w), x(1.0), x(1.0), x(share - half_u), x(share + half_u), x(share));
}

}  // namespace kerfbench::report
