// SPDX-License-Identifier: Apache-2.0
#include "twin/cutter/limit_switches.h"

#include <cmath>

namespace kerfbench::twin {

void LimitSwitches::predict(const std::array<MotionForecast, 2>& gantry, Tick until,
                            std::vector<SensorEdge>& edges) {
  constexpr std::array kSignals{Signal::kLimitX, Signal::kLimitY};
  for (std::size_t i = 0; i < gantry.size(); ++i) {
    const MotionForecast& axis = gantry.at(i);
    const double end_mm = axis.placeAfter_mm(rate_.seconds(until - axis.now));
    const bool beyond_max = end_mm > max_mm_.at(i);
    const bool tripped = beyond_max || end_mm < min_mm_.at(i);
    if (tripped == sent_.at(i)) continue;
    sent_.at(i) = tripped;
    // Selects one of the two switches: the one that the axis ran onto, or the one that it came from.
    const bool at_max =
        tripped ? beyond_max
                : std::abs(axis.place_mm - max_mm_.at(i)) < std::abs(axis.place_mm - min_mm_.at(i));
    const double goal_mm = at_max ? max_mm_.at(i) : min_mm_.at(i);
    edges.push_back({axis.tickAt(goal_mm, at_max == tripped, rate_, until), kSignals.at(i), tripped});
  }
}

}  // namespace kerfbench::twin
