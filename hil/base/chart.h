// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::base {

/// One curve of a chart: strokes of one colour, with a name beside the chart.
struct ChartCurve {
  using Stroke = std::vector<Eigen::Vector2d>;
  std::string name;
  std::vector<Stroke> strokes;
  bool dashed{};
};

/// A chart with two scales, for a page or a paper: one SVG, nothing loaded from elsewhere.
struct Chart {
  std::string title, x_name, y_name;
  std::vector<ChartCurve> curves;
  bool logarithmic{};  ///< Both scales; all values are > 0.
  bool same_scale{};   ///< A unit is as long along x as along y: for places.
};

/// @throws std::invalid_argument without points, or with values that the scales do not hold.
std::string svgOf(const Chart& chart);

/// 1, 2 or 5 times a power of ten, so that a range > 0 has four to ten of them.
double roundStep(double range);

}  // namespace kerfbench::base
