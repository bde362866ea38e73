// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/print_layout.h"
#include "twin/base/signal_map.h"

namespace kerfbench::twin {

/// How the belt will move on from now, as far as the present tells.
struct BeltForecast {
  Tick now{};
  double travel_mm{};
  double speed_mm_s{};
  double acceleration_mm_s2{};
};

/// Turns the belt's motion into edges of encoder and print-mark sensor, one quantum ahead. Edges join without
/// gap or repetition: each forecast continues from the last edge that was sent, and what a forecast missed by
/// a fraction of a count comes out right in the next.
class BeltSensors {
 public:
  /// `first_mark_mm`: belt travel at which the eye mark of unit 0 reaches the sensor.
  BeltSensors(TickRate rate, double encoder_count_mm, const PrintLayout& print, double first_mark_mm);

  /// Edges in (forecast.now, until], by tick.
  std::vector<SensorEdge> edges(const BeltForecast& forecast, Tick until);

 private:
  void encoderEdges(const BeltForecast& forecast, Tick until, std::vector<SensorEdge>& edges);
  [[nodiscard]] double markEdgeTravel_mm(long long edge) const;
  void markEdges(const BeltForecast& forecast, Tick until, std::vector<SensorEdge>& edges);

  TickRate rate_;
  double encoder_count_mm_;
  PrintLayout print_;
  double first_mark_mm_;
  long long count_{0};  ///< Encoder count that the controller has been told.
  long long mark_edges_{
      0};  ///< Of unit 0's begin, unit 0's end, unit 1's begin, …: how many lie behind the belt.
};

}  // namespace kerfbench::twin
