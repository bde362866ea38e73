// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "hil/base/spilled_vector.h"
#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"

namespace kerfbench::source {

/// An edge of the belt's encoder and what it makes of the count.
struct EncoderEdge {
  double time_s{};
  long long counts{};  ///< Quadrature counts since the start, after this edge; > 0 along +Wx.
};

/// Edges of A and B to counts: A leads B when the belt runs along +Wx; both are low at the start.
class EncoderCounter {
 public:
  explicit EncoderCounter(TickRate rate) : rate_(rate) {}

  /// Takes edges by tick. Nullopt: no edge of the encoder; other signals are passed over.
  std::optional<EncoderEdge> take(const SensorEdge& edge) {
    if (edge.signal != Signal::kEncoderA && edge.signal != Signal::kEncoderB) return std::nullopt;
    const bool of_a = edge.signal == Signal::kEncoderA;
    bool& line = of_a ? a_ : b_;
    if (line == edge.level) return std::nullopt;
    line = edge.level;
    // Forwards, behind an edge of A they differ, behind one of B they are equal.
    counts_ += of_a == (a_ != b_) ? 1 : -1;
    return EncoderEdge{rate_.seconds(edge.tick), counts_};
  }

 private:
  TickRate rate_;
  bool a_{};
  bool b_{};
  long long counts_{};
};

/// All edges of a recording's encoder, by time.
base::SpilledVector<EncoderEdge> encoderEdges(const base::SpilledVector<SensorEdge>& sensors, TickRate rate);

}  // namespace kerfbench::source
