// SPDX-License-Identifier: Apache-2.0
#include "twin/five_axis/five_axis_head.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kerfbench::twin {

using Eigen::Vector3d;

FiveAxisHead::FiveAxisHead(const FiveAxisDescription& description) : description_(description) {
  if (const std::string faults = faultsOf(description); !faults.empty())
    throw std::invalid_argument("FiveAxisHead: " + faults);
  const FiveAxisErrors& errors = description_.errors;
  zero_mm_ = focusOf(Vector3d(0.0, 0.0, description_.pivot_mm), errors.a_zero_rad, errors.c_zero_rad);
}

Vector3d FiveAxisHead::axisOf(double a_rad, double c_rad) {
  return {std::sin(c_rad) * std::sin(a_rad), -std::cos(c_rad) * std::sin(a_rad), std::cos(a_rad)};
}

Vector3d FiveAxisHead::focusOf(const Vector3d& pivot_mm, double a_rad, double c_rad) const {
  const FiveAxisErrors& errors = description_.errors;
  const Vector3d leaning(errors.squareness_rad * pivot_mm.y(), 0.0, 0.0);
  return pivot_mm + leaning - (description_.pivot_mm + errors.pivot_mm) * axisOf(a_rad, c_rad) - zero_mm_;
}

FiveAxisPlaces FiveAxisHead::placesFor(const FiveAxisPose& pose) const {
  const auto whole = [](double value, double step) { return step * std::round(value / step); };
  const Vector3d pivot_mm = pose.p_WQ_mm + description_.pivot_mm * axisOf(pose.a_rad, pose.c_rad);
  FiveAxisPlaces places;
  for (Eigen::Index i = 0; i < 3; ++i) places.pivot_mm[i] = whole(pivot_mm[i], description_.linear_step_mm);
  places.a_rad = whole(pose.a_rad, description_.turn_step_rad);
  places.c_rad = whole(pose.c_rad, description_.turn_step_rad);
  return places;
}

FiveAxisBeam FiveAxisHead::moveTo(const FiveAxisPose& pose) {
  const FiveAxisErrors& errors = description_.errors;
  const FiveAxisPlaces places = placesFor(pose);
  if (!moved_) {
    a_rad_ = places.a_rad;
    c_rad_ = places.c_rad;
    moved_ = true;
  }
  a_rad_ = std::clamp(a_rad_, places.a_rad - 0.5 * errors.a_backlash_rad,
                      places.a_rad + 0.5 * errors.a_backlash_rad);
  c_rad_ = std::clamp(c_rad_, places.c_rad - 0.5 * errors.c_backlash_rad,
                      places.c_rad + 0.5 * errors.c_backlash_rad);
  const double a_rad = a_rad_ + errors.a_zero_rad;
  const double c_rad = c_rad_ + errors.c_zero_rad;
  return {focusOf(places.pivot_mm, a_rad, c_rad), axisOf(a_rad, c_rad)};
}

}  // namespace kerfbench::twin
