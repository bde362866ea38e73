// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"
#include "twin/cutter/motion_forecast.h"

namespace kerfbench::twin {

/// Switches at both ends of the gantry's axes; those of one axis share a pin. They trip at the place that the
/// forecast gives, not at the next quantum.
class LimitSwitches {
 public:
  LimitSwitches(TickRate rate, const std::array<double, 2>& travel_min_mm,
                const std::array<double, 2>& travel_max_mm)
      : rate_(rate), min_mm_(travel_min_mm), max_mm_(travel_max_mm) {}

  /// Appends the edges in (now, until] of kLimitX and kLimitY. `gantry`: place of the gantry along x and y.
  void predict(const std::array<MotionForecast, 2>& gantry, Tick until, std::vector<SensorEdge>& edges);

 private:
  TickRate rate_;
  std::array<double, 2> min_mm_;
  std::array<double, 2> max_mm_;
  std::array<bool, 2> sent_{};  ///< State of each pin as the controller has received it.
};

}  // namespace kerfbench::twin
