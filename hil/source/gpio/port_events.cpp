// SPDX-License-Identifier: Apache-2.0
#include "hil/source/gpio/port_events.h"

namespace kerfbench::source {

void PortEvents::start(const std::vector<bool>& levels, Tick tick, std::vector<PinEvent>& events) {
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (levels[i]) levels_[pins_[i].port] |= maskOf(i);
  }
  for (const auto& [port, level] : levels_) events.push_back({tick, port, level, level, PinEvent::kNone});
}

void PortEvents::add(const LineEdge& edge, Tick tick, std::vector<PinEvent>& events) {
  const PinId pin = pins_[edge.line];
  std::uint16_t& level = levels_[pin.port];
  const std::uint16_t changed = edge.changed ? maskOf(edge.line) : std::uint16_t{0};
  level ^= changed;
  PinEvent* event = nullptr;
  for (auto it = events.rbegin(); it != events.rend() && it->tick == tick; ++it) {
    if (it->port == pin.port) event = &*it;
  }
  if (event == nullptr) event = &events.emplace_back(PinEvent{tick, pin.port, 0, level, PinEvent::kNone});
  event->changed |= changed;
  event->level = level;
  if (edge.gap) event->flags |= PinEvent::kGap;
}

}  // namespace kerfbench::source
