// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/files/target.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace kerfbench::calibrate {

std::string CalibrationTarget::faults() const {
  std::string text;
  const auto require = [&text](bool fine, const std::string& rule) {
    if (!fine) text += (text.empty() ? "" : "; ") + rule;
  };
  require(columns >= 4 && columns <= 200, "columns must be 4 … 200");
  require(rows >= 4 && rows <= 200, "rows must be 4 … 200");
  require(square_mm >= 0.1 && square_mm <= 1000.0, "square_mm must be 0.1 … 1000");
  require(marker_mm >= 0.4 * square_mm && marker_mm <= 0.8 * square_mm,
          "marker_mm must be 0.4 … 0.8 of square_mm");
  if (text.empty())
    require(markers() <= kMostMarkers, fmt::format("has {} markers, {} at most", markers(), kMostMarkers));
  return text;
}

// Row r begins with a white square if r is odd; squares before it: half of all, the smaller half of a row
// first.
Eigen::Vector2i CalibrationTarget::squareOf(int marker) const {
  if (marker < 0 || marker >= markers()) throw std::out_of_range("calibration target: no such marker");
  const int in_pair = columns;  // White squares of two rows.
  const int pair = marker / in_pair;
  const int rest = marker % in_pair;
  const int in_first = columns / 2;
  if (rest < in_first) return {2 * rest + 1, 2 * pair};
  return {2 * (rest - in_first), 2 * pair + 1};
}

int CalibrationTarget::markerIn(int column, int row) const {
  if (column < 0 || row < 0 || column >= columns || row >= rows || (column + row) % 2 == 0) return -1;
  const int before = (row / 2) * columns + (row % 2 == 1 ? columns / 2 : 0);
  return before + column / 2;
}

CalibrationTarget targetFor(const Eigen::Vector2d& field_mm, double margin, double least_square_mm) {
  const Eigen::Vector2d size_mm = (1.0 + 2.0 * margin) * field_mm;
  for (double decade = 0.1;; decade *= 10.0) {
    for (const double step : {1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0}) {
      CalibrationTarget target;
      target.square_mm = decade * step;
      if (target.square_mm < least_square_mm) continue;
      target.columns = std::max(4, static_cast<int>(std::ceil(size_mm.x() / target.square_mm)));
      target.rows = std::max(4, static_cast<int>(std::ceil(size_mm.y() / target.square_mm)));
      target.marker_mm = 0.6 * target.square_mm;
      if (target.columns <= 200 && target.rows <= 200 && target.markers() <= CalibrationTarget::kMostMarkers)
        return target;
    }
    if (decade > 1e6) throw std::invalid_argument("calibration target: the field is too large");
  }
}

}  // namespace kerfbench::calibrate
