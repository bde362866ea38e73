// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "hil/gauge/gauge_report.h"
#include "hil/report/html_text.h"
#include "hil/report/plot.h"

namespace kerfbench::gauge {
namespace {

/// µm, or a dash for what was not found.
std::string micrometres(double mm, bool sign) {
  if (!std::isfinite(mm)) return "–";
  return sign ? fmt::format("{:+.2f}", 1e3 * mm) : fmt::format("{:.2f}", 1e3 * mm);
}

}  // namespace

std::string fieldPlot(const std::vector<FieldCell>& field) {
  if (field.empty()) return {};
  Eigen::AlignedBox2d box;
  double most_mm = 1e-6;
  std::vector<double> sigma;
  for (const FieldCell& c : field) {
    box.extend(c.p_V_mm);
    most_mm = std::max(most_mm, c.bias_mm.norm());
    sigma.push_back(c.sigma_mm);
  }
  const Eigen::Vector2d low = box.min() - Eigen::Vector2d::Constant(3.5);
  const Eigen::Vector2d size = box.sizes() + Eigen::Vector2d::Constant(7.0);
  const double scale = 3.2 / most_mm;  // The longest arrow nearly leaves its cell of 5 mm.
  std::string svg =
      fmt::format("<svg class=field viewBox='{:.1f} {:.1f} {:.1f} {:.1f}' role=img aria-label='Field'>",
                  low.x(), -low.y() - size.y(), size.x(), size.y());
  for (const FieldCell& c : field) {
    const double share = c.bias_mm.norm() / most_mm;
    svg += fmt::format(
        "<rect class=cell x={:.1f} y={:.1f} width=4.8 height=4.8 style='fill-opacity:{:.2f}'><title>x "
        "{:.1f}, "
        "y {:.1f} mm: {:+.3f}, {:+.3f} µm (± {:.3f}), {} readings</title></rect>",
        c.p_V_mm.x() - 2.4, -c.p_V_mm.y() - 2.4, 0.06 + 0.5 * share, c.p_V_mm.x(), c.p_V_mm.y(),
        1e3 * c.bias_mm.x(), 1e3 * c.bias_mm.y(), 2e3 * c.sigma_mm, c.readings);
    const Eigen::Vector2d tip = c.p_V_mm + scale * c.bias_mm;
    svg += fmt::format(
        "<circle class=root cx={0:.2f} cy={1:.2f} r=0.35 /><line class=arrow x1={0:.2f} y1={1:.2f} "
        "x2={2:.2f} y2={3:.2f} />",
        c.p_V_mm.x(), -c.p_V_mm.y(), tip.x(), -tip.y());
  }
  return fmt::format(
      "<figure>{}</svg><figcaption>Mean error of readings over the kerf camera's field (plane V, cells of "
      "5 mm); the longest arrow is {:.3f} µm, a cell's mean is known to about {:.3f} µm (k = 2)."
      "</figcaption></figure>",
      svg, 1e3 * most_mm, 2e3 * quantileOf(sigma, 0.5));
}

std::string detectablePlot(const std::vector<KindResult>& kinds) {
  report::Plot plot(45.0, 65.0, 0.0, static_cast<double>(kinds.size()), "Smallest detectable size");
  plot.xTicks(report::ticks(45.0, 65.0),
              "smallest size that is FAIL in 95 % of cases, with 95 % confidence, µm");
  plot.vertical(50.0, "lim");
  double row = static_cast<double>(kinds.size()) - 0.5;
  for (const KindResult& k : kinds) {
    const double y = plot.y(row);
    plot.raw(
        fmt::format("<text class=tick x=-4 y={:.1f} text-anchor=end>{}</text>", y + 3.5, faultName(k.kind)));
    if (std::isfinite(k.detectable_mm)) {
      plot.raw(fmt::format(
          "<rect class=bar x=0 y={:.1f} width={:.1f} height=12 /><text class=tick x={:.1f} y={:.1f} >{:.2f}"
          "</text>",
          y - 6.0, plot.x(1e3 * k.detectable_mm), plot.x(1e3 * k.detectable_mm) + 4.0, y + 3.5,
          1e3 * k.detectable_mm));
    } else {
      const auto fails = k.bad.find(inspect::Verdict::kFail);
      const bool none = fails == k.bad.end() || fails->second == 0;
      plot.raw(fmt::format("<text class='tick warn' x=6 y={:.1f} >{}</text>", y + 3.5,
                           none ? "never FAIL up to 120 µm" : "too few cases (59 are needed)"));
    }
    row -= 1.0;
  }
  return plot.figure("Smallest detectable size of each fault kind (distribution-free tolerance bound).");
}

std::string coveragePlot(const std::vector<Coverage>& coverage) {
  constexpr double kRow = 17.0;
  const double height = kRow * static_cast<double>(coverage.size());
  const auto x = [](double share) { return 420.0 * (std::clamp(share, 0.7, 1.0) - 0.7) / 0.3; };
  std::string svg = fmt::format(
      "<svg class=plot viewBox='-236 -8 900 {:.0f}' role=img aria-label='Coverage'><rect class=frame x=0 y=0 "
      "width=420 "
      "height={:.0f} /><rect class=goal x={:.1f} y=0 width={:.1f} height={:.0f} />",
      height + 36.0, height, x(0.94), x(0.968) - x(0.94), height);
  for (const double share : {0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0}) {
    svg += fmt::format(
        "<line class=grid x1={0:.1f} x2={0:.1f} y1=0 y2={1:.0f} /><text class=tick x={0:.1f} y={2:.0f} "
        "text-anchor=middle>{3:.0f} %</text>",
        x(share), height, height + 14.0, 100.0 * share);
  }
  double y = 0.5 * kRow;
  for (const Coverage& c : coverage) {
    const double share = c.cases == 0 ? 0.0 : static_cast<double>(c.hits) / static_cast<double>(c.cases);
    svg += fmt::format("<text class=tick x=-6 y={:.1f} text-anchor=end>{}</text>", y + 3.5,
                       report::escapeHtml(c.quantity));
    svg += fmt::format(
        "<line class=ci x1={:.1f} x2={:.1f} y1={:.1f} y2={:.1f} /><circle class={} cx={:.1f} cy={:.1f} r=3.2 "
        "/>",
        x(c.share.low), x(c.share.high), y, y, share >= 0.94 && share <= 0.968 ? "hold" : "off", x(share), y);
    svg += fmt::format("<text class=tick x=428 y={:.1f}>{:.1f} % of {}; bias {}, σ {}, U {} µm</text>",
                       y + 3.5, 100.0 * share, c.cases, micrometres(c.error_mm.mean, true),
                       micrometres(c.error_mm.sigma, false), micrometres(c.U_median_mm, false));
    y += kRow;
  }
  return svg + "</svg>";
}

}  // namespace kerfbench::gauge
