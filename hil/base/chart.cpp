// SPDX-License-Identifier: Apache-2.0
#include "hil/base/chart.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "hil/base/text.h"

namespace kerfbench::base {
namespace {

using Eigen::Vector2d;

constexpr double kWidth = 560.0, kHeight = 320.0;                            // Frame, px.
constexpr double kLeft = 72.0, kTop = 34.0, kRight = 190.0, kBottom = 48.0;  // Borders around the frame, px.
constexpr const char* kColours[] = {"#1f5fa8", "#c0392b", "#2d8a4e", "#8a5a00"};

/// Scales of a chart: from values to px.
class Scales {
 public:
  explicit Scales(const Chart& chart) : logarithmic_(chart.logarithmic) {
    for (const ChartCurve& curve : chart.curves) {
      for (const ChartCurve::Stroke& stroke : curve.strokes)
        for (const Vector2d& point : stroke) hold(shown(point));
    }
    if (box_.isEmpty()) throw std::invalid_argument("a chart needs points");
    for (int axis = 0; axis < 2; ++axis) {
      const double margin = 0.04 * box_.sizes()[axis];
      const double room = margin > 0.0 ? margin : 1.0;
      box_.min()[axis] -= room;
      box_.max()[axis] += room;
    }
    if (chart.same_scale) widen();
  }

  [[nodiscard]] Vector2d px(const Vector2d& value) const {
    const Vector2d share = (shown(value) - box_.min()).cwiseQuotient(box_.sizes());
    return {kLeft + kWidth * share.x(), kTop + kHeight * (1.0 - share.y())};
  }
  /// Values with a line across, along an axis.
  [[nodiscard]] std::vector<double> ticks(int axis) const {
    const double step = logarithmic_ ? 1.0 : roundStep(box_.sizes()[axis]);
    std::vector<double> at;
    for (double k = std::ceil(box_.min()[axis] / step); k * step <= box_.max()[axis]; k += 1.0)
      at.push_back(logarithmic_ ? std::pow(10.0, k) : k * step + 0.0);
    return at;
  }

 private:
  void hold(const Vector2d& at) {
    if (!at.allFinite()) throw std::invalid_argument("a chart's values must be numbers that its scales hold");
    box_.extend(at);
  }
  /// Widens the shorter side until both have one scale.
  void widen() {
    const Vector2d frame_px(kWidth, kHeight);
    const double unit = box_.sizes().cwiseQuotient(frame_px).maxCoeff();
    const Vector2d more = 0.5 * (unit * frame_px - box_.sizes());
    box_ = Eigen::AlignedBox2d(box_.min() - more, box_.max() + more);
  }
  [[nodiscard]] Vector2d shown(const Vector2d& value) const {
    return logarithmic_ ? Vector2d(std::log10(value.x()), std::log10(value.y())) : value;
  }

  bool logarithmic_;
  Eigen::AlignedBox2d box_;
};

std::string gridOf(const Scales& scales) {
  std::string svg;
  for (const double v : scales.ticks(0)) {
    const double x = scales.px({v, 1.0}).x();
    svg += fmt::format(
        "<path d='M {0:.2f} {1:.2f} V {2:.2f}' class='grid'/><text x='{0:.2f}' y='{3:.2f}' "
        "text-anchor='middle'>{4:g}</text>\n",
        x, kTop, kTop + kHeight, kTop + kHeight + 16.0, v);
  }
  for (const double v : scales.ticks(1)) {
    const double y = scales.px({1.0, v}).y();
    svg += fmt::format(
        "<path d='M {0:.2f} {1:.2f} H {2:.2f}' class='grid'/><text x='{3:.2f}' y='{4:.2f}' "
        "text-anchor='end'>{5:g}</text>\n",
        kLeft, y, kLeft + kWidth, kLeft - 6.0, y + 4.0, v);
  }
  return svg;
}

std::string curveOf(const Scales& scales, const ChartCurve& curve, const char* colour, double legend_y) {
  std::string way;
  for (const ChartCurve::Stroke& stroke : curve.strokes) {
    for (std::size_t i = 0; i < stroke.size(); ++i) {
      const Vector2d px = scales.px(stroke[i]);
      way += fmt::format("{}{:.2f} {:.2f}", i == 0 ? "M " : " L ", px.x(), px.y());
    }
  }
  const std::string style =
      fmt::format("stroke='{}'{}", colour, curve.dashed ? " stroke-dasharray='6 4'" : "");
  return fmt::format(
      "<path d='{}' class='curve' {}/>\n<path d='M {:.1f} {:.1f} h 24' class='curve' {}/><text x='{:.1f}' "
      "y='{:.1f}'>{}</text>\n",
      way, style, kLeft + kWidth + 12.0, legend_y, style, kLeft + kWidth + 42.0, legend_y + 4.0,
      escapeHtml(curve.name));
}

}  // namespace

double roundStep(double range) {
  const double power = std::pow(10.0, std::floor(std::log10(range / 4.0)));
  const double rest = range / 4.0 / power;
  return power * (rest >= 5.0 ? 5.0 : rest >= 2.0 ? 2.0 : 1.0);
}

std::string svgOf(const Chart& chart) {
  const Scales scales(chart);
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='{0:.0f}' height='{1:.0f}' viewBox='0 0 {0:.0f} "
      "{1:.0f}'>\n"
      "<style>text{{font:12px "
      "sans-serif}}.grid{{stroke:#ddd;fill:none}}.curve{{stroke-width:1.6;fill:none}}</style>\n"
      "<rect width='100%' height='100%' fill='#fff'/>\n"
      "<text x='{2:.0f}' y='20' font-weight='bold'>{3}</text>\n",
      kLeft + kWidth + kRight, kTop + kHeight + kBottom, kLeft, escapeHtml(chart.title));
  svg += gridOf(scales);
  svg += fmt::format("<rect x='{}' y='{}' width='{}' height='{}' fill='none' stroke='#888'/>\n", kLeft, kTop,
                     kWidth, kHeight);
  for (std::size_t i = 0; i < chart.curves.size(); ++i) {
    svg += curveOf(scales, chart.curves[i], kColours[i % std::size(kColours)],
                   kTop + 10.0 + 17.0 * static_cast<double>(i));
  }
  svg += fmt::format(
      "<text x='{:.0f}' y='{:.0f}' text-anchor='middle'>{}</text>\n"
      "<text transform='translate(16 {:.0f}) rotate(-90)' text-anchor='middle'>{}</text>\n",
      kLeft + 0.5 * kWidth, kTop + kHeight + 38.0, escapeHtml(chart.x_name), kTop + 0.5 * kHeight,
      escapeHtml(chart.y_name));
  return svg + "</svg>\n";
}

}  // namespace kerfbench::base
