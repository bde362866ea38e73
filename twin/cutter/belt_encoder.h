// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/random.h"
#include "twin/base/signal_map.h"
#include "twin/cutter/motion_forecast.h"
#include "twin/description/description.h"

namespace kerfbench::twin {

/// Quadrature encoder on the belt's roller: turns the roller's travel into edges of A and B, one quantum
/// ahead. Edges join without gap or repetition: each forecast continues from the last edge that was sent, and
/// what a forecast missed by a fraction of a count comes out right in the next.
///
/// A disc that is mounted off centre reads, for a travel s of a roller of radius R,
///
///     s + runout (sin(s/R + phase) - sin(phase))
///
/// and its line k stands at reading (k + jitter_k) count_mm: the same place whenever the belt passes it.
class BeltEncoder {
 public:
  /// No edge is further from its place than this, so that edges never change order.
  static constexpr double kMaxJitter_counts = 0.4;

  /// `encoder` without faults (see faultsOf). A and B are low at the start, wherever between two lines it is.
  BeltEncoder(TickRate rate, const EncoderDescription& encoder, double roller_radius_mm, std::uint64_t seed);

  /// Appends the edges in (roller.now, until], by tick. `roller`: travel of the roller's surface since t = 0.
  void predict(const MotionForecast& roller, Tick until, std::vector<SensorEdge>& edges);

 private:
  [[nodiscard]] double reading_mm(double travel_mm) const;
  [[nodiscard]] double travelAt_mm(double reading_mm) const;
  [[nodiscard]] double line_mm(long long line) const;
  [[nodiscard]] long long countAt(double reading_mm) const;

  TickRate rate_;
  EncoderDescription encoder_;
  double radius_mm_;
  CounterRandom random_;
  long long first_;  ///< Count at the start, where A and B are low.
  long long count_;  ///< Count that the controller has been told.
};

}  // namespace kerfbench::twin
