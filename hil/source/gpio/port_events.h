// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <vector>

#include "hil/source/gpio/edge_order.h"
#include "twin/base/pin_event.h"

namespace kerfbench::source {

/// Makes events of the controller's ports of edges of lines: edges of one port at one tick are one event, as
/// in any recording.
class PortEvents {
 public:
  /// The pin behind each line.
  explicit PortEvents(std::vector<PinId> pins) : pins_(std::move(pins)) {}

  /// Appends the levels at the start, as events of this tick: a pin is low before its first event.
  void start(const std::vector<bool>& levels, Tick tick, std::vector<PinEvent>& events);
  /// Appends an edge, or merges it into the event of its tick and port; ticks ascend.
  void add(const LineEdge& edge, Tick tick, std::vector<PinEvent>& events);

 private:
  [[nodiscard]] std::uint16_t maskOf(std::size_t line) const {
    return static_cast<std::uint16_t>(1U << pins_[line].bit);
  }

  std::vector<PinId> pins_;
  std::map<std::uint16_t, std::uint16_t> levels_;  ///< Levels of each port.
};

}  // namespace kerfbench::source
