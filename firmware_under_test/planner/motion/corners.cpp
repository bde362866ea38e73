// SPDX-License-Identifier: Apache-2.0
#include "firmware_under_test/planner/motion/corners.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerfbench::planner {
namespace {

/// Half of the mean deviation of a critically damped drive's response from its delay: 2 e^-2.
constexpr double kLagShare = 0.2707;
/// Turn below which a joint is rounding of coordinates.
constexpr double kNoTurnRad = 1e-9;

}  // namespace

double turnSpeed(double turn_rad, double acceleration_mm_s2, double period_s, const CornerLimits& corners) {
  if (turn_rad <= kNoTurnRad) return std::numeric_limits<double>::infinity();
  const double change = 2.0 * std::sin(0.5 * turn_rad);
  const double by_drives = acceleration_mm_s2 * period_s * (1.0 / change - 0.5);
  if (corners.error_mm <= 0.0) return std::max(0.0, by_drives);
  const double braking_mm = acceleration_mm_s2 * corners.lag_s * corners.lag_s / 8.0;
  const double by_error =
      (corners.error_mm / change - braking_mm) / (kLagShare * corners.lag_s + 0.25 * period_s);
  return std::max(0.0, std::min(by_drives, by_error));
}

}  // namespace kerfbench::planner
