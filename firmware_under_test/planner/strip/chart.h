// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::planner {

/// One curve of a chart.
struct ChartCurve {
  std::string name;
  std::vector<Eigen::Vector2d> points;
  bool dashed{};
};

/// A chart with two scales, for a page or a paper: one SVG, nothing loaded from elsewhere.
struct Chart {
  std::string title, x_name, y_name;
  std::vector<ChartCurve> curves;
  bool logarithmic{};  ///< Both scales; all values are > 0.
};

/// @throws std::invalid_argument without points, or with values that the scales do not hold.
std::string svgOf(const Chart& chart);

}  // namespace kerfbench::planner
