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
/// an error of a forecast by a fraction of a count is made good in the next.
///
/// A disc with an eccentric mounting reads, for a travel s of a roller of radius R,
class BeltEncoder {
 public:
  /// Largest displacement of an edge from its place; keeps the order of edges.
  static constexpr double kMaxJitter_counts = 0.4;

  /// Makes the encoder. `encoder` has no faults (see faultsOf). A and B are low at the start, wherever
  /// between two lines the belt is.
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
  long long count_;  ///< Count that the controller has received.
};

}  // namespace kerfbench::twin
