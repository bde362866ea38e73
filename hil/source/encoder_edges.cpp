// SPDX-License-Identifier: Apache-2.0
#include "hil/source/encoder_edges.h"

namespace kerfbench::source {

base::SpilledVector<EncoderEdge> encoderEdges(const base::SpilledVector<SensorEdge>& sensors, TickRate rate) {
  base::SpilledVector<EncoderEdge> edges;
  EncoderCounter counter(rate);
  for (const SensorEdge& sensor : sensors.streamed()) {
    if (const auto edge = counter.take(sensor)) edges.push_back(*edge);
  }
  return edges;
}

}  // namespace kerfbench::source
