// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "twin/base/pin_event.h"

namespace kerfbench::twin {

/// Forecast of a motion from `now` on, at constant acceleration.
struct MotionForecast {
  Tick now{};
  double place_mm{};
  double speed_mm_s{};
  double acceleration_mm_s2{};

  [[nodiscard]] double placeAfter_mm(double dt_s) const {
    return place_mm + (speed_mm_s + 0.5 * acceleration_mm_s2 * dt_s) * dt_s;
  }
  /// Seconds from now until the motion first passes `goal_mm` in this direction; 0 if it has already,
  /// infinity if never.
  [[nodiscard]] double timeTo_s(double goal_mm, bool forward) const {
    const double sign = forward ? 1.0 : -1.0;
    const double distance = sign * (goal_mm - place_mm);
    const double v = sign * speed_mm_s;
    const double a = sign * acceleration_mm_s2;
    if (distance <= 0.0) return 0.0;
    const double square = v * v + 2.0 * a * distance;
    if (square < 0.0 || (v <= 0.0 && a <= 0.0)) return std::numeric_limits<double>::infinity();
    // Root in the form without cancellation.
    return v > 0.0 ? 2.0 * distance / (v + std::sqrt(square)) : (std::sqrt(square) - v) / a;
  }
  /// First tick of (now, until] after the motion has passed `goal_mm`; `until` if it does not get there.
  [[nodiscard]] Tick tickAt(double goal_mm, bool forward, TickRate rate, Tick until) const {
    const double dt_s = std::min(timeTo_s(goal_mm, forward), rate.seconds(until - now));
    return std::clamp<Tick>(now + rate.ticksAt(dt_s) + 1, now + 1, until);
  }
};

}  // namespace kerfbench::twin
