// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/sheet_place.h"

#include <cmath>

namespace kerfbench::desk {
namespace {

using Eigen::Vector2d;

/// Registration marks lie so far from the drawing, and from each other at least.
constexpr double kMarkOff_mm = 7.0;
constexpr double kMarkIn_mm = 5.0;
/// Room between one unit's drawing and the next one's.
constexpr double kBetweenUnits_mm = 20.0;

double rounded(double value, double step) { return std::round(value / step) * step + 0.0; }

}  // namespace

SheetPlace placeOnSheet(const Eigen::AlignedBox2d& box, const Eigen::AlignedBox2d& field) {
  SheetPlace place;
  if (box.min().y() < field.min().y() || box.max().y() > field.max().y())
    place.shift_y_mm = rounded(field.center().y() - box.center().y(), 0.001);
  const double in_mm = box.sizes().x() > 4.0 * kMarkIn_mm ? kMarkIn_mm : -kMarkIn_mm;
  const double left = rounded(box.min().x() + in_mm, 0.5), right = rounded(box.max().x() - in_mm, 0.5);
  const double low = rounded(box.min().y() + place.shift_y_mm - kMarkOff_mm, 0.5);
  const double high = rounded(box.max().y() + place.shift_y_mm + kMarkOff_mm, 0.5);
  const double fifth = rounded(left + 0.7 * (right - left), 0.5);
  place.marks_mm = {Vector2d(left, low), Vector2d(left, high), Vector2d(right, low), Vector2d(right, high),
                    Vector2d(fifth, high)};
  place.pitch_mm = std::ceil(box.sizes().x() + kBetweenUnits_mm);
  place.start_x_mm = rounded(field.center().x() - box.center().x(), 0.001);
  return place;
}

}  // namespace kerfbench::desk
