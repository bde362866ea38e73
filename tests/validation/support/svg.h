// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::validation {

/// An axis of a plot; low == high: fitted to the data.
struct PlotAxis {
  std::string label;
  bool log{false};
  double low{}, high{};
};

struct PlotLine {
  std::string name;
  std::vector<Eigen::Vector2d> points;  ///< A point that is not finite breaks the line.
  bool line{true};
  bool dots{false};
};

struct PlotLimit {
  double value{};  ///< Value on the y axis.
  std::string name;
};

/// Curves over an axis.
struct LinePlot {
  std::string title;
  PlotAxis x, y;
  std::vector<PlotLine> lines;
  std::vector<PlotLimit> limits{};
  bool equal_scales{false};  ///< True if one unit is as long along y as along x: a picture of a path.
};

/// A field of numbered cells, coloured from good (limit or less) to bad.
struct CellPlot {
  std::string title, x_label, y_label;
  std::vector<std::string> columns, rows;
  std::vector<std::vector<double>> value;      ///< Values, [row][column].
  std::vector<std::vector<std::string>> text;  ///< Texts of the cells.
  double limit{};                              ///< Cells above it are drawn in red tones.
};

/// Plot as a whole SVG document, the same bytes for the same plot.
std::string svgOf(const LinePlot& plot);
std::string svgOf(const CellPlot& plot);

}  // namespace kerfbench::validation
