// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/target_print.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/aruco.hpp>

namespace kerfbench::calibrate {
namespace {

std::string rectangle(double x, double y, double width, double height) {
  return fmt::format("M{:.6g} {:.6g}h{:.6g}v{:.6g}h{:.6g}z", x, y, width, height, -width);
}

/// Black cells of the markers, runs of a row joined.
std::string markerPath(const CalibrationTarget& target) {
  std::string path;
  constexpr int kCells = CalibrationTarget::kMarkerCells;
  const double cell_mm = target.marker_mm / kCells;
  const double border_mm = 0.5 * (target.square_mm - target.marker_mm);
  for (int id = 0; id < target.markers(); ++id) {
    const Eigen::Vector2d corner_mm =
        target.square_mm * target.squareOf(id).cast<double>() + Eigen::Vector2d::Constant(border_mm);
    const std::vector<std::uint8_t> cells = markerCells(id);
    const auto black = [&](int x, int y) { return cells[static_cast<std::size_t>(y * kCells + x)] == 0; };
    for (int y = 0; y < kCells; ++y) {
      for (int x = 0; x < kCells;) {
        const int begin = x;
        while (x < kCells && black(x, y)) ++x;
        if (x > begin)
          path += rectangle(corner_mm.x() + begin * cell_mm, corner_mm.y() + y * cell_mm,
                            (x - begin) * cell_mm, cell_mm);
        else
          ++x;
      }
    }
    path += "\n";
  }
  return path;
}

/// 1, 2, 5, 10 … mm, not longer than this.
double rulerLength(double most_mm) {
  const double decade = std::pow(10.0, std::floor(std::log10(most_mm)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= most_mm) return step * decade;
  }
  return decade;
}

}  // namespace

std::vector<std::uint8_t> markerCells(int marker) {
  if (marker < 0 || marker >= CalibrationTarget::kMostMarkers)
    throw std::out_of_range("calibration target: no such marker");
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_1000);
  cv::Mat picture;
  dictionary->drawMarker(marker, CalibrationTarget::kMarkerCells, picture, 1);
  std::vector<std::uint8_t> cells;
  for (int r = 0; r < picture.rows; ++r) {
    for (int c = 0; c < picture.cols; ++c)
      cells.push_back(picture.at<std::uint8_t>(r, c) != 0 ? std::uint8_t{1} : std::uint8_t{0});
  }
  return cells;
}

std::string targetSvg(const CalibrationTarget& target) {
  const double margin_mm = std::max(10.0, target.square_mm);
  const Eigen::Vector2d size_mm = target.size_mm();
  const double width_mm = size_mm.x() + 2.0 * margin_mm;
  const double height_mm = size_mm.y() + 2.0 * margin_mm;
  const double ruler_mm = rulerLength(size_mm.x());
  const double ruler_y_mm = size_mm.y() + 0.35 * margin_mm;
  const double text_mm = std::clamp(size_mm.x() / 60.0, 0.6, 4.0);
  std::string squares;
  for (int row = 0; row < target.rows; ++row) {
    for (int column = row % 2; column < target.columns; column += 2)
      squares +=
          rectangle(column * target.square_mm, row * target.square_mm, target.square_mm, target.square_mm);
    squares += "\n";
  }
  const std::string ruler = fmt::format("M0 {0:.6g}h{1:.6g}M0 {2:.6g}v{3:.6g}M{1:.6g} {2:.6g}v{3:.6g}",
                                        ruler_y_mm, ruler_mm, ruler_y_mm - 0.1 * margin_mm, 0.2 * margin_mm);
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.6g}mm\" height=\"{1:.6g}mm\" "
      "viewBox=\"{2:.6g} {2:.6g} {0:.6g} {1:.6g}\">\n"
      "<rect x=\"{2:.6g}\" y=\"{2:.6g}\" width=\"{0:.6g}\" height=\"{1:.6g}\" fill=\"#fff\"/>\n"
      "<path fill=\"#000\" d=\"{3}\"/>\n<path fill=\"#000\" d=\"{4}\"/>\n"
      "<path fill=\"none\" stroke=\"#000\" stroke-width=\"{5:.6g}\" d=\"{6}\"/>\n"
      "<text x=\"0\" y=\"{7:.6g}\" font-family=\"sans-serif\" font-size=\"{8:.6g}\">The line is {9:g} mm "
      "long. "
      "Kerfbench target: {10} x {11} squares of {12:g} mm, markers 5X5_1000 of {13:g} mm. Origin: upper left "
      "corner "
      "of the squares.</text>\n</svg>\n",
      width_mm, height_mm, -margin_mm, squares, markerPath(target), 0.02 * margin_mm, ruler,
      ruler_y_mm + 0.15 * margin_mm + text_mm, text_mm, ruler_mm, target.columns, target.rows,
      target.square_mm, target.marker_mm);
}

}  // namespace kerfbench::calibrate
