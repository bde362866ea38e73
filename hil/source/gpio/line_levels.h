// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/source/gpio/edge_order.h"
#include "hil/source/gpio/line_request.h"
#include "hil/source/gpio/wires.h"
#include "hil/source/pin_capture.h"

namespace kerfbench::source {

/// Lines that must not have the level that they have before the first edge, in words.
std::vector<std::string> wrongAtStart(const std::vector<GpioWire>& wires, const std::vector<bool>& levels,
                                      const StartLevels& wanted);

/// Second check that no edge was lost: each line has the level of its last edge. In words, the lines that
/// have another, or why nobody knows.
std::vector<std::string> levelsAgainstEdges(LineRequest& request, const EdgeOrder& order);

/// Faults of the edges in words, with the place of the first one.
std::vector<std::string> edgeTroubles(const EdgeOrder& order, std::uint64_t begin_ns);

}  // namespace kerfbench::source
