// SPDX-License-Identifier: Apache-2.0
// Stillness over time: where sheet and spot went, and what was left between them.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "hil/report/html_text.h"

namespace kerfbench::report {
namespace {

constexpr std::size_t kMaxPlots = 9;
constexpr std::size_t kMaxRows = 20;
constexpr std::size_t kMaxPlotPoints = 250;
constexpr double kWidth = 240.0;
constexpr double kHeight = 96.0;
constexpr double kGap = 16.0;  // Between the two panels.

/// Least-squares line through values over time.
struct Line {
  double mean_t{}, mean{}, slope{};
  [[nodiscard]] double at(double t) const { return mean + slope * (t - mean_t); }
};

Line lineThrough(const std::vector<double>& t, const std::vector<double>& y) {
  Line line;
  const auto n = static_cast<double>(t.size());
  for (std::size_t i = 0; i < t.size(); ++i) {
    line.mean_t += t[i] / n;
    line.mean += y[i] / n;
  }
  double tt = 0.0;
  double ty = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    tt += (t[i] - line.mean_t) * (t[i] - line.mean_t);
    ty += (t[i] - line.mean_t) * (y[i] - line.mean);
  }
  line.slope = tt > 0.0 ? ty / tt : 0.0;
  return line;
}

/// One panel: values over the time of a cut, symmetric about zero.
class Panel {
 public:
  Panel(const std::vector<double>& time_s, double top, double full_mm)
      : time_s_(time_s), top_(top), full_mm_(full_mm) {}

  [[nodiscard]] double x(double t_s) const {
    return kWidth * (t_s - time_s_.front()) / std::max(time_s_.back() - time_s_.front(), 1e-9);
  }
  [[nodiscard]] double y(double e_mm) const { return top_ + 0.5 * kHeight * (1.0 - e_mm / full_mm_); }
  [[nodiscard]] std::string frame() const {
    return fmt::format("<rect class=frame x=0 y={:.0f} width={:.0f} height={:.0f} />", top_, kWidth, kHeight);
  }
  [[nodiscard]] std::string level(double at_mm, std::string_view look, bool number) const {
    std::string svg =
        fmt::format("<line class={} x1=0 x2={:.0f} y1={:.1f} y2={:.1f} />", look, kWidth, y(at_mm), y(at_mm));
    if (number) {
      svg += fmt::format("<text class=tick x=-4 y={:.1f} text-anchor=end>{:+.0f}</text>", y(at_mm) + 3.0,
                         1e3 * at_mm);
    }
    return svg;
  }
  [[nodiscard]] std::string dots(const std::vector<double>& values_mm, std::string_view look) const {
    const std::size_t stride =
        std::max<std::size_t>((values_mm.size() + kMaxPlotPoints - 1) / kMaxPlotPoints, 1);
    std::string d;
    for (std::size_t i = 0; i < values_mm.size(); i += stride)
      fmt::format_to(std::back_inserter(d), "M{:.1f} {:.1f}h0", x(time_s_[i]), y(values_mm[i]));
    return fmt::format("<path class='{}' d='{}'/>", look, d);
  }

 private:
  const std::vector<double>& time_s_;
  double top_;
  double full_mm_;
};

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

/// Zero, the limits, and numbers where there is room for them.
std::string levels(const Panel& panel, double most_mm, double limit_mm) {
  const bool far = most_mm > 5.0 * limit_mm;
  std::string svg = panel.level(0.0, "zero", true);
  for (const double sign : {1.0, -1.0}) {
    svg += panel.level(sign * limit_mm, "lim", !far);
    if (far) svg += panel.level(sign * most_mm, "zero", true);
  }
  return svg;
}

/// Above: sheet and spot, less the sheet's mean speed from the first frame to the last. Below: their
/// difference.
std::string cutPlot(const inspect::CutResult& cut, double limit_mm) {
  const double span_s = cut.time_s.back() - cut.time_s.front();
  const double speed_mm_s = (cut.sheet_x_mm.back() - cut.sheet_x_mm.front()) / std::max(span_s, 1e-9);
  std::vector<double> sheet_mm = cut.sheet_x_mm;
  for (std::size_t i = 0; i < sheet_mm.size(); ++i)
    sheet_mm[i] -= cut.sheet_x_mm.front() + speed_mm_s * (cut.time_s[i] - cut.time_s.front());
  std::vector<double> spot_mm = sheet_mm;
  for (std::size_t i = 0; i < spot_mm.size(); ++i) spot_mm[i] += cut.residual_mm[i];

  const double motion_mm = std::max({limit_mm, largest(sheet_mm), largest(spot_mm)});
  const Panel motion(cut.time_s, 0.0, 1.15 * motion_mm);
  const double residual_mm = std::max(limit_mm, largest(cut.residual_mm));
  const double base = kHeight + kGap;
  const Panel residual(cut.time_s, base, 1.15 * residual_mm);
  std::string svg = fmt::format(
      "<figure><svg class=plot viewBox='-40 -6 {:.0f} {:.0f}' role=img aria-label='x of spot and sheet over "
      "time, and their difference'>",
      kWidth + 46.0, base + kHeight + 22.0);
  svg += motion.frame() + residual.frame();
  for (const double at_mm : {motion_mm, 0.0, -motion_mm}) svg += motion.level(at_mm, "zero", true);
  svg += motion.dots(sheet_mm, "dots sheetdots") + motion.dots(spot_mm, "dots");
  svg += levels(residual, residual_mm, limit_mm);
  svg += residual.dots(cut.residual_mm, "dots");
  const Line drift = lineThrough(cut.time_s, cut.residual_mm);
  svg += fmt::format("<line class=fit x1=0 x2={:.0f} y1={:.1f} y2={:.1f} />", kWidth,
                     residual.y(drift.at(cut.time_s.front())), residual.y(drift.at(cut.time_s.back())));
  svg += fmt::format(
      "<text class=tick x=0 y={:.0f}>{:.3f} s</text><text class=tick x={:.0f} y={:.0f} "
      "text-anchor=end>+{:.0f} ms</text></svg><figcaption>unit {}, E{}: drift <b>{:+.1f} µm</b>, astray by "
      "{:.1f} µm, offset {:+.1f} µm; sheet at {:.3f} mm/s</figcaption></figure>",
      base + kHeight + 13.0, cut.time_s.front(), kWidth, base + kHeight + 13.0, 1e3 * span_s, cut.unit,
      cut.entity, 1e3 * cut.drift_mm, 1e3 * cut.excursion_mm, 1e3 * cut.offset_mm, speed_mm_s);
  return svg;
}

double worstOf(const inspect::CutResult& cut) { return std::max(std::abs(cut.drift_mm), cut.excursion_mm); }

}  // namespace

std::string stillnessFigures(const RunReport& report) {
  std::vector<const inspect::CutResult*> cuts;
  for (const inspect::CutResult& cut : report.result.cuts) {
    if (std::isfinite(cut.drift_mm)) cuts.push_back(&cut);
  }
  if (cuts.empty()) return {};
  std::stable_sort(cuts.begin(), cuts.end(), [](const inspect::CutResult* a, const inspect::CutResult* b) {
    return worstOf(*a) > worstOf(*b);
  });
  std::string html = "<div class=plots>";
  for (std::size_t i = 0; i < std::min(cuts.size(), kMaxPlots); ++i)
    html += cutPlot(*cuts[i], report.limits.stillness_mm);
  html +=
      "</div><p class=note>All in µm, each dot a frame. Above: x of the <span class=sheetword>sheet</span> "
      "and of "
      "the <span class=spotword>spot</span>, each less the sheet's mean speed in this cut. A spot that "
      "rests on the sheet covers its dots; one that goes by the sheet's mean speed stays on a straight line "
      "while "
      "the sheet leaves it. Below: spot less its place on the sheet; red: limit; the line is the "
      "least-squares "
      "drift. The worst cuts.</p>";
  html +=
      "<table><thead><tr><th>Cut<th class=num>Start, s<th class=num>Length, ms<th class=num>Frames<th "
      "class=num>Drift ± U, µm<th class=num>Offset ± U, µm<th class=num>Astray ± U, µm<th class=num>Peak, "
      "µm<th "
      "class=num>RMS, µm<th class=num>Top speed, mm/s</tr></thead><tbody>";
  for (std::size_t i = 0; i < std::min(cuts.size(), kMaxRows); ++i) {
    const inspect::CutResult& c = *cuts[i];
    html += fmt::format(
        "<tr><td>unit {}, E{}<td class=num>{:.4f}<td class=num>{:.1f}<td class=num>{}<td class=num>{:+.1f} ± "
        "{:.1f}<td class=num>{:+.1f} ± {:.1f}<td class=num>{:.1f} ± {:.1f}<td class=num>{:.1f}<td "
        "class=num>{:.1f}<td class=num>{:.0f}</tr>",
        c.unit, c.entity, c.start_s, 1e3 * (c.end_s - c.start_s), c.frames, 1e3 * c.drift_mm,
        2e3 * c.drift_sigma_mm, 1e3 * c.offset_mm, 2e3 * c.offset_sigma_mm, 1e3 * c.excursion_mm,
        1e3 * c.excursion_U_mm, 1e3 * c.peak_mm, 1e3 * c.rms_mm, c.top_speed_mm_s);
  }
  html += "</tbody></table>";
  html += fmt::format(
      "<p class=note>{} of {} cuts let x be seen{}</p>", cuts.size(), report.result.cuts.size(),
      cuts.size() > kMaxRows ? fmt::format("; the {} worst are listed, all are in verdict.json.", kMaxRows)
                             : std::string("."));
  return html;
}

}  // namespace kerfbench::report
