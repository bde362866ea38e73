// SPDX-License-Identifier: Apache-2.0
#include "hil/source/encoder_edges.h"

namespace kerfbench::source {

std::vector<EncoderEdge> encoderEdges(std::span<const SensorEdge> sensors, TickRate rate) {
  std::vector<EncoderEdge> edges;
  bool a = false;
  bool b = false;
  long long counts = 0;
  for (const SensorEdge& edge : sensors) {
    if (edge.signal != Signal::kEncoderA && edge.signal != Signal::kEncoderB) continue;
    const bool of_a = edge.signal == Signal::kEncoderA;
    bool& line = of_a ? a : b;
    if (line == edge.level) continue;
    line = edge.level;
    // Forwards, behind an edge of A they differ, behind one of B they are equal.
    counts += of_a == (a != b) ? 1 : -1;
    edges.push_back({rate.seconds(edge.tick), counts});
  }
  return edges;
}

}  // namespace kerfbench::source
