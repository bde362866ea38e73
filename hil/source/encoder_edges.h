// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"

namespace kerfbench::source {

/// An edge of the belt's encoder and what it makes of the count.
struct EncoderEdge {
  double time_s{};
  long long counts{};  ///< Quadrature counts since the start, after this edge; > 0 along +Wx.
};

/// Edges of A and B to counts: A leads B when the belt runs along +Wx; both are low at the start. `sensors`
/// by tick; other signals among them are passed over.
std::vector<EncoderEdge> encoderEdges(std::span<const SensorEdge> sensors, TickRate rate);

}  // namespace kerfbench::source
