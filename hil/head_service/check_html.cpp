// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hil/calibrate/files/day.h"
#include "hil/head_service/check_report.h"
#include "hil/head_service/head_figures.h"
#include "hil/report/html_text.h"
#include "hil/report/plot.h"

namespace kerfbench::head_service {
namespace {

using calibrate::HeadDrift;

constexpr std::string_view kCheckCss = R"css(
svg.headmap{background:var(--card);border-radius:6px;max-height:520px}.headmap line{stroke-width:1.5;stroke-linecap:round;vector-effect:non-scaling-stroke}
.f0{stroke:var(--b0);fill:var(--b0)}.f1{stroke:var(--b1);fill:var(--b1)}.f2{stroke:var(--b2);fill:var(--b2)}
.f3{stroke:var(--b3);fill:var(--b3)}.f4{stroke:var(--b4);fill:var(--b4)}.headmap circle{stroke:none}
.wantedgrid,.scalebar{fill:none;vector-effect:non-scaling-stroke}.wantedgrid{stroke:var(--nom);stroke-width:.7;opacity:.55}.scalebar{stroke:var(--fg);stroke-width:2.5}
.whisker{stroke:var(--acc);stroke-width:1.6}
)css";

/// How a drift is shown: "zero of x" in µm, gains in ppm, the turn in µrad.
struct Shown {
  double scale;
  std::string_view unit;
};
Shown shownOf(HeadDrift drift) {
  switch (drift) {
    case HeadDrift::kGainX:
    case HeadDrift::kGainY:
      return {1e6, "ppm"};
    case HeadDrift::kTurn:
      return {1e6, "µrad"};
    default:
      return {1e3, "µm"};
  }
}

std::string withU(double value, double U) {
  const int digits = U > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(U))), 0, 6) : 3;
  return fmt::format("{:+.{}f} ± {:.{}f}", value, digits, U, digits);
}

std::string driftRow(const calibrate::DriftFinding& drift, double effect_mm) {
  const auto [scale, unit] = shownOf(drift.which);
  return fmt::format(
      "<tr><td>{}<td class=num>{}<td>{}<td class=num>{}<td>{}</tr>", calibrate::nameOf(drift.which),
      withU(scale * drift.value, 2.0 * scale * drift.sigma), unit,
      effect_mm > 0.0 ? withU(1e3 * effect_mm * drift.value, 2e3 * effect_mm * drift.sigma) : "–",
      drift.changed ? "<b>changed</b>" : "");
}

std::string whatChanged(const calibrate::QuickCheckResult& result, const CheckFacts& facts) {
  const auto effects = effectsAtRim(facts.field_W_mm);
  std::string html =
      "<table><thead><tr><th>Of the head<th class=num>Value ± U (k = 2)<th>Unit<th class=num>At the rim, "
      "µm<th></tr>"
      "</thead><tbody>";
  for (std::size_t k = 0; k < result.drifts.size(); ++k)
    html += driftRow(result.drifts[k], k < effects.size() ? effects[k] : 0.0);
  return html +
         "</tbody></table><p class=note>Changed: one of the fewest that explain what was measured. Height of "
         "the sheet "
         "and equal gains of both axes are nearly the same to a head without a lens; then their U is large. "
         "At the rim: "
         "by how much it moves the beam there.</p>";
}

std::string dayOr(const std::optional<int>& day, std::string_view none) {
  return day ? calibrate::isoDay(*day) : std::string(none);
}

std::string trendRow(HeadDrift which, const DriftTrend& trend, double effect_mm) {
  const auto [scale, unit] = shownOf(which);
  return fmt::format("<tr><td>{}<td class=num>{}<td>{}<td class=num>{}<td>{}<td>{}<td>{}</tr>",
                     calibrate::nameOf(which), withU(scale * trend.per_month, scale * trend.U_per_month),
                     unit, withU(1e3 * effect_mm * trend.per_month, 1e3 * effect_mm * trend.U_per_month),
                     trend.drifts() ? "<b>drifts</b>" : "no drift is proven",
                     dayOr(trend.may_day, "not within ten years"),
                     dayOr(trend.likely_day, "not within ten years"));
}

std::string trendPlot(const std::vector<HeadCheckRecord>& records, std::size_t k,
                      const std::optional<DriftTrend>& trend, double effect_mm, double limit_mm) {
  const auto which = static_cast<HeadDrift>(k);
  const auto [scale, unit] = shownOf(which);
  const int first = calibrate::dayNumber(records.front().date).value();
  const int last = calibrate::dayNumber(records.back().date).value();
  double most = 0.0;
  for (const HeadCheckRecord& record : records)
    most = std::max(most, scale * (std::abs(record.drifts[k].value) + record.drifts[k].U));
  const double limit = scale * limit_mm / effect_mm;
  const double span = std::max(10, last - first),
               y = 1.15 * (most > 0.4 * limit ? std::max(most, limit) : most);
  report::Plot plot(-0.04 * span, 1.04 * span, -y, y,
                    fmt::format("{} over the checks", calibrate::nameOf(which)));
  plot.xTicks(report::ticks(0.0, span), fmt::format("days since {}", records.front().date));
  plot.yTicks(report::ticks(-y, y), "{:+g}");
  plot.horizontal(0.0, "zero");
  for (const double side : {-limit, limit})
    if (std::abs(side) <= y) plot.horizontal(side, "lim");
  if (trend) {
    const double slope = scale * trend->per_month / (365.25 / 12.0), from = scale * trend->first_value;
    plot.raw(fmt::format("<line class=fit x1={:.1f} x2={:.1f} y1={:.1f} y2={:.1f} />", plot.x(0.0),
                         plot.x(last - first), plot.y(from), plot.y(from + slope * (last - first))));
  }
  for (const HeadCheckRecord& record : records) {
    const double x = plot.x(calibrate::dayNumber(record.date).value() - first);
    const double v = scale * record.drifts[k].value, U = scale * record.drifts[k].U;
    plot.raw(
        fmt::format("<line class=whisker x1={0:.1f} x2={0:.1f} y1={1:.1f} y2={2:.1f} /><path class=dots "
                    "d='M{0:.1f} {3:.1f}h0'/>",
                    x, plot.y(v - U), plot.y(v + U), plot.y(v)));
  }
  return plot.figure(fmt::format("{}, {}, ± U (k = 2){}{}", calibrate::nameOf(which), unit,
                                 trend ? "; the line is the drift" : "",
                                 limit <= y ? "; red: where it alone reaches the limit" : ""));
}

std::string trends(const std::vector<HeadCheckRecord>& records, const CheckFacts& facts) {
  if (records.empty()) return {};
  const auto effects = effectsAtRim(facts.field_W_mm);
  std::string rows, plots;
  for (std::size_t k = 0; k < kFollowedDrifts; ++k) {
    const auto trend = trendOf(records, k, effects[k], facts.limit_mm);
    if (trend) rows += trendRow(static_cast<HeadDrift>(k), *trend, effects[k]);
    plots += trendPlot(records, k, trend, effects[k], facts.limit_mm);
  }
  std::string html;
  if (rows.empty()) {
    html = "<p>A drift needs three checks on two days at least.</p>";
  } else {
    html =
        "<table><thead><tr><th>Drift<th class=num>A month ± U (k = 2)<th>Unit<th class=num>At the rim, µm a "
        "month"
        "<th><th>May reach the limit<th>Reaches it</tr></thead><tbody>" +
        rows + "</tbody></table>";
  }
  html += fmt::format(
      "<div class=figs>{}</div><p class=note>Straight lines through the checks that were held against the "
      "same "
      "calibration, weighted by their U; where they scatter more than that, U of the line is raised. The "
      "height of the "
      "sheet is taken as unchanged here, and is told as gains. The limit is {}, at the rim of the field and "
      "for one "
      "drift alone: together they reach it earlier. May: value and U; reaches: the line itself, if it goes "
      "on as it "
      "came.</p>",
      plots, lengthText(facts.limit_mm));
  return html;
}

std::string checksTable(const std::vector<HeadCheckRecord>& records) {
  std::string html = "<table><thead><tr><th>Date<th>Holds<th class=num>Off at most, µm";
  for (std::size_t k = 0; k < kFollowedDrifts; ++k) {
    const auto which = static_cast<HeadDrift>(k);
    html += fmt::format("<th class=num>{}, {}", calibrate::nameOf(which), shownOf(which).unit);
  }
  html += "</tr></thead><tbody>";
  for (auto record = records.rbegin(); record != records.rend(); ++record) {
    html += fmt::format("<tr><td>{}<td>{}<td class=num>{:.1f}", record->date,
                        record->holds ? "yes" : "<b>no</b>", 1e3 * record->off_mm);
    for (std::size_t k = 0; k < kFollowedDrifts; ++k) {
      const double scale = shownOf(static_cast<HeadDrift>(k)).scale;
      html += fmt::format("<td class=num>{}",
                          withU(scale * record->drifts[k].value, scale * record->drifts[k].U));
    }
    html += "</tr>";
  }
  return report::scrolled("All checks", html + "</tbody></table>");
}

std::string marksFigure(const MeasuredSheet& sheet, const CheckFacts& facts) {
  std::vector<PlaceError> errors;
  for (const MeasuredMark& mark : sheet.marks) errors.push_back({mark.wanted.p_W_mm, mark.error_mm()});
  std::string html = "<div class=panels>" + errorArrows(facts.field_W_mm, errors, facts.limit_mm) +
                     "</div><div class=legend>" + report::limitLegend(facts.limit_mm) + "</div>";
  std::string remarks;
  for (const std::string& remark : sheet.remarks) remarks += "<li>" + report::escapeHtml(remark);
  return remarks.empty() ? html : html + "<ul>" + remarks + "</ul>";
}

}  // namespace

std::vector<HeadCheckRecord> comparable(const std::vector<HeadCheckRecord>& history,
                                        const HeadCheckRecord& record) {
  std::vector<HeadCheckRecord> same;
  std::ranges::copy_if(history, std::back_inserter(same), [&](const HeadCheckRecord& other) {
    return other.machine == record.machine && other.calibration == record.calibration;
  });
  return same;
}

std::string checkHtml(const calibrate::QuickCheckResult& result, const MeasuredSheet& sheet,
                      const std::vector<HeadCheckRecord>& history, const CheckFacts& facts) {
  const std::string_view verdict = result.holds ? "HOLDS" : "DOES NOT HOLD";
  std::string page = report::htmlPageHead(fmt::format("{} – check of {}", verdict, facts.machine), kCheckCss);
  page += fmt::format(
      "<header class={}><div class=big>{}</div><p>{}. The beam is off by {} at most at {} marks.</p><div "
      "class=facts>{}"
      "</div></header>\n",
      result.holds ? "pass" : "fail", verdict,
      report::escapeHtml(result.holds ? "The correction holds: nothing changed beyond what chance explains"
                                      : "Since it was calibrated " + result.words),
      lengthText(errorsOf({&sheet, 1}).max_mm), sheet.marks.size(),
      report::htmlFacts({{"Machine", facts.machine},
                         {"Date", facts.date},
                         {"Kerf camera", facts.camera},
                         {"Held against", facts.calibration},
                         {"Kerfbench", facts.version}}));
  page += report::htmlSection("What changed", whatChanged(result, facts));
  page += report::htmlSection("Trend", trends(history, facts));
  page += report::htmlSection("The marks", marksFigure(sheet, facts));
  page += report::htmlSection("All checks", checksTable(history));
  page += report::htmlSection("How it was made",
                              "<table><tbody>" + report::htmlRow("Repeat with", facts.command, true) +
                                  report::htmlRow("Table at work", facts.table) +
                                  report::htmlRow("Calibration", facts.calibration) + "</tbody></table>");
  return page.append(report::kHtmlPageEnd);
}

}  // namespace kerfbench::head_service
