// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/print_layout.h"
#include "twin/base/random.h"
#include "twin/base/signal_map.h"
#include "twin/cutter/motion_forecast.h"
#include "twin/description/description.h"

namespace kerfbench::twin {

/// Sensor that sees each unit's printed eye mark come and go, one quantum ahead; it joins forecasts as
/// BeltEncoder does.
///
/// An edge of the print is seen at its real place, plus a jitter of its own that is the same whenever the
/// edge passes (at most 0.4 of the distance to its neighbour); backwards it is seen later by the hysteresis.
class PrintMarkSensor {
 public:
  /// Makes the sensor. `first_mark_mm`: travel of the sheet at which the leading edge of unit 0's eye mark
  /// reaches the sensor.
  PrintMarkSensor(TickRate rate, const PrintMarkSensorDescription& sensor, const PrintLayout& print,
                  double first_mark_mm, std::uint64_t seed);

  /// Appends the edges in (sheet.now, until], by tick. `sheet`: travel of the sheet since t = 0.
  void predict(const MotionForecast& sheet, Tick until, std::vector<SensorEdge>& edges);

 private:
  [[nodiscard]] double edge_mm(long long edge) const;

  TickRate rate_;
  PrintMarkSensorDescription sensor_;
  PrintLayout print_;
  double first_mark_mm_;
  double max_jitter_mm_;
  CounterRandom random_;
  /// Number of edges behind the sensor, counting unit 0's begin, unit 0's end, unit 1's begin, …
  long long passed_{0};
};

}  // namespace kerfbench::twin
