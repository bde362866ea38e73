// SPDX-License-Identifier: Apache-2.0
// The time line of a run that was to be stopped: cause, gate off, last pulse, word.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hil/report/html_answer.h"
#include "hil/report/html_text.h"
#include "hil/report/plot.h"

namespace kerfbench::report {
namespace {

constexpr double kSafeWidth = 760.0;
constexpr double kSafeRow = 34.0;

/// What had to happen by when, and when it did.
struct SafeStep {
  std::string what;
  double due_s{};
  double happened_s{};  ///< NaN: never.
};

std::vector<SafeStep> stepsOf(const SafeTimeline& safe) {
  return {{"laser's gate off", safe.laser_due_s, safe.gate_off_s},
          {"last pulse of an axis", safe.axes_due_s, safe.last_pulse_s},
          {safe.word.empty() ? "message of the controller" : "message: " + safe.word, safe.word_due_s,
           safe.word_s}};
}

std::string afterCause(double time_s, double cause_s) {
  return std::isfinite(time_s) ? fmt::format("{:+.4g} ms", 1e3 * (time_s - cause_s)) : std::string("never");
}

/// Milliseconds after the cause, logarithmic from kFine_ms on: the gate has a tenth of a millisecond, words
/// have fifty.
struct SafeScale {
  static constexpr double kFine_ms = 0.01;
  double from_ms{}, to_ms{};
  static double squeezed(double ms) { return std::copysign(std::log10(1.0 + std::abs(ms) / kFine_ms), ms); }
  [[nodiscard]] double x(double ms) const {
    const double from = squeezed(from_ms);
    return kSafeWidth * (squeezed(std::clamp(ms, from_ms, to_ms)) - from) / (squeezed(to_ms) - from);
  }
  /// 0 and powers of ten of milliseconds, on either side.
  [[nodiscard]] std::vector<double> marks() const {
    std::vector<double> found{0.0};
    for (double ms = kFine_ms; ms < std::max(to_ms, -from_ms); ms *= 10.0) {
      if (ms < to_ms) found.push_back(ms);
      if (-ms > from_ms) found.push_back(-ms);
    }
    return found;
  }
};

SafeScale scaleOf(const SafeTimeline& safe) {
  double from_ms = 0.0;
  double to_ms = 1e-3;
  const auto include = [&](double time_s) {
    if (!std::isfinite(time_s)) return;
    from_ms = std::min(from_ms, 1e3 * (time_s - safe.cause_s));
    to_ms = std::max(to_ms, 1e3 * (time_s - safe.cause_s));
  };
  for (const SafeStep& step : stepsOf(safe)) {
    include(step.due_s);
    include(step.happened_s);
  }
  return {1.5 * from_ms, 1.5 * to_ms};
}

std::string safeRow(const SafeTimeline& safe, const SafeStep& step, const SafeScale& scale, double y) {
  const double due_ms = 1e3 * (step.due_s - safe.cause_s);
  std::string svg = fmt::format(
      "<text x=-8 y={0:.0f} text-anchor=end>{1}</text><rect class=mayspan x={2:.1f} y={3:.0f} width={4:.1f} "
      "height=16 ><title>allowed until {5}</title></rect>",
      y + 4.0, escapeHtml(step.what), scale.x(0.0), y - 8.0, scale.x(due_ms) - scale.x(0.0),
      afterCause(step.due_s, safe.cause_s));
  if (!std::isfinite(step.happened_s)) return svg;
  const double ms = 1e3 * (step.happened_s - safe.cause_s);
  return svg + fmt::format(
                   "<circle class={} cx={:.1f} cy={:.0f} r=5 /><text class=tick x={:.1f} y={:.0f}>{}</text>",
                   step.happened_s > step.due_s ? "toolate" : "happened", scale.x(ms), y, scale.x(ms) + 8.0,
                   y + 4.0, afterCause(step.happened_s, safe.cause_s));
}

std::string safeTable(const SafeTimeline& safe) {
  std::string html =
      "<table><thead><tr><th scope=col>What<th scope=col class=num>At, s<th scope=col class=num>After the "
      "cause<th scope=col class=num>Allowed</tr></thead><tbody>";
  html += fmt::format("<tr><th scope=row>cause: {}<td class=num>{:.6f}<td class=num>0<td class=num>–</tr>",
                      escapeHtml(safe.cause), safe.cause_s);
  if (safe.known_s > safe.cause_s)
    html += fmt::format(
        "<tr><th scope=row>by then it can be known<td class=num>{:.6f}<td class=num>{}<td "
        "class=num>–</tr>",
        safe.known_s, afterCause(safe.known_s, safe.cause_s));
  for (const SafeStep& step : stepsOf(safe)) {
    html += fmt::format("<tr><th scope=row>{}<td class=num>{}<td class='num{}'>{}<td class=num>{}</tr>",
                        escapeHtml(step.what),
                        std::isfinite(step.happened_s) ? fmt::format("{:.6f}", step.happened_s) : "–",
                        step.happened_s <= step.due_s ? "" : " hit",
                        afterCause(step.happened_s, safe.cause_s), afterCause(step.due_s, safe.cause_s));
  }
  return html + "</tbody></table>";
}

}  // namespace

std::string safeTimelineFigure(const RunReport& report) {
  if (!report.safe || !std::isfinite(report.safe->cause_s)) return {};
  const SafeTimeline& safe = *report.safe;
  const SafeScale scale = scaleOf(safe);
  const std::vector<SafeStep> steps = stepsOf(safe);
  const double bottom = kSafeRow * static_cast<double>(steps.size()) + 12.0;
  std::string svg = fmt::format(
      "<svg class=wave viewBox='-170 -16 {:.0f} {:.0f}' role=img aria-label='Time line of the stop'>",
      kSafeWidth + 260.0, bottom + 46.0);
  for (const double ms : scale.marks()) {
    svg += fmt::format(
        "<line class=grid x1={0:.1f} x2={0:.1f} y1=0 y2={1:.0f} /><text class=tick x={0:.1f} y={2:.0f} "
        "text-anchor=middle>{3:g} ms</text>",
        scale.x(ms), bottom, bottom + 14.0, ms);
  }
  svg += fmt::format(
      "<line class=now x1={0:.1f} x2={0:.1f} y1=0 y2={1:.0f} /><text x={0:.1f} y=-4 "
      "text-anchor=middle>cause</text>",
      scale.x(0.0), bottom);
  double y = 0.5 * kSafeRow + 6.0;
  for (const SafeStep& step : steps) {
    svg += safeRow(safe, step, scale, y);
    y += kSafeRow;
  }
  return "<figure>" + scrolled("Time line", svg + "</svg>") +
         "<figcaption>Time after the cause, on a logarithmic axis. Green: what is "
         "allowed.</figcaption></figure>" +
         safeTable(safe);
}

}  // namespace kerfbench::report
