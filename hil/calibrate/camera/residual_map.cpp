// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/residual_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "hil/base/text.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kWidth = 760.0;  // Width of the camera's picture in the drawing.
constexpr double kTop = 70.0;
constexpr double kLeft = 20.0;
constexpr int kCellsAcross = 24;

struct Cell {
  Eigen::Vector2d sum_px{Eigen::Vector2d::Zero()};
  int count{};
};

struct Grid {
  int columns{}, rows{};
  std::vector<Cell> cells;
  double cell{};  ///< Side in the drawing.
};

Grid gridOf(const CameraCalibrationResult& result) {
  const vision::CameraCalibration& c = result.calibration;
  Grid grid;
  grid.columns = kCellsAcross;
  grid.rows = std::max(1, static_cast<int>(std::lround(1.0 * kCellsAcross * c.height_px / c.width_px)));
  grid.cell = kWidth / grid.columns;
  grid.cells.resize(static_cast<std::size_t>(grid.columns * grid.rows));
  for (const CalibratedView& view : result.views) {
    for (std::size_t i = 0; i < view.corners.size(); ++i) {
      const Eigen::Vector2d& pixel = view.corners[i].pixel;
      const int x =
          std::clamp(static_cast<int>((pixel.x() + 0.5) / c.width_px * grid.columns), 0, grid.columns - 1);
      const int y =
          std::clamp(static_cast<int>((pixel.y() + 0.5) / c.height_px * grid.rows), 0, grid.rows - 1);
      Cell& cell = grid.cells[static_cast<std::size_t>(y * grid.columns + x)];
      cell.sum_px += view.residuals_px[i];
      ++cell.count;
    }
  }
  return grid;
}

/// 1, 2 or 5 times a power of ten, at least this.
double roundUp(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * decade >= value) return step * decade;
  }
  return 10.0 * decade;
}

std::string drawCells(const Grid& grid, double arrow_per_px) {
  int most = 1;
  for (const Cell& cell : grid.cells) most = std::max(most, cell.count);
  std::string text;
  for (int y = 0; y < grid.rows; ++y) {
    for (int x = 0; x < grid.columns; ++x) {
      const Cell& cell = grid.cells[static_cast<std::size_t>(y * grid.columns + x)];
      const double left = kLeft + x * grid.cell;
      const double top = kTop + y * grid.cell;
      const int gray = 255 - static_cast<int>(60.0 * cell.count / most);
      text += fmt::format(
          "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\" fill=\"{}\"/>\n", left, top,
          grid.cell, grid.cell, cell.count == 0 ? "#f4a6a0" : fmt::format("#{0:02x}{0:02x}{0:02x}", gray));
      if (cell.count == 0) continue;
      const Eigen::Vector2d mean_px = cell.sum_px / cell.count;
      const Eigen::Vector2d from(left + 0.5 * grid.cell, top + 0.5 * grid.cell);
      const Eigen::Vector2d to = from + arrow_per_px * mean_px;
      text += fmt::format(
          "<path d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}\" stroke=\"#104e8b\"/><circle cx=\"{:.2f}\" cy=\"{:.2f}\" "
          "r=\"1.3\" fill=\"#104e8b\"/>\n",
          from.x(), from.y(), to.x(), to.y(), from.x(), from.y());
    }
  }
  return text;
}

std::string viewTable(const CameraCalibrationResult& result, double x, double y) {
  std::string text = fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" font-weight=\"bold\">view: corners, sigma, "
      "tilt, blur</text>\n",
      x, y);
  for (const CalibratedView& view : result.views) {
    y += 17.0;
    text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}: {}, {:.4f} px, {:.1f}°, {:.2f} px</text>\n", x,
                        y, base::escapeHtml(view.name), view.corners.size(), view.sigma_px,
                        180.0 / std::numbers::pi * view.tilt_rad, view.blur_px);
  }
  return text;
}

}  // namespace

std::string residualMapSvg(const CameraCalibrationResult& result) {
  const vision::CameraCalibration& c = result.calibration;
  const Grid grid = gridOf(result);
  double longest_px = 1e-6;
  for (const Cell& cell : grid.cells) {
    if (cell.count > 0) longest_px = std::max(longest_px, cell.sum_px.norm() / cell.count);
  }
  const double scale_px = roundUp(longest_px);
  const double arrow_per_px = 1.5 * grid.cell / scale_px;
  const double height = grid.rows * grid.cell;
  const double bar_y = kTop + height + 24.0;
  const double total_height =
      std::max(bar_y + 20.0, kTop + 40.0 + 17.0 * static_cast<double>(result.views.size()));
  return fmt::format(
             "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
             "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1160 {:.0f}\" "
             "font-family=\"sans-serif\" "
             "font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
             "<text x=\"20\" y=\"26\" font-size=\"17\">Camera {}, {}: residuals of {} corners in {} "
             "views</text>\n"
             "<text x=\"20\" y=\"50\">RMS {:.4f} px per axis; largest standard uncertainty of the map {:.3f} "
             "µm; "
             "area {:.1f} … {:.1f} by {:.1f} … {:.1f} mm; {} outliers left out</text>\n",
             total_height, base::escapeHtml(c.camera_id), base::escapeHtml(c.date), result.corners,
             result.views.size(), c.rms_px, 1e3 * c.map_u_mm, c.area_mm.min().x(), c.area_mm.max().x(),
             c.area_mm.min().y(), c.area_mm.max().y(), result.outliers) +
         drawCells(grid, arrow_per_px) + viewTable(result, kLeft + kWidth + 20.0, kTop + 12.0) +
         fmt::format(
             "<path d=\"M{0:.1f} {1:.1f}h{2:.1f}\" stroke=\"#104e8b\" stroke-width=\"2\"/>\n"
             "<text x=\"{3:.1f}\" y=\"{4:.1f}\">{5:g} px, mean of a cell's corners ({6:.0f} x); grey: "
             "corners, red: none</text>\n</svg>\n",
             kLeft, bar_y, arrow_per_px * scale_px, kLeft + arrow_per_px * scale_px + 10.0, bar_y + 4.0,
             scale_px, arrow_per_px * c.width_px / kWidth);
}

}  // namespace kerfbench::calibrate
