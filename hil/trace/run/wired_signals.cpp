// SPDX-License-Identifier: Apache-2.0
#include "hil/trace/run/wired_signals.h"

#include <algorithm>

namespace kerfbench::trace {

WiredSignals::WiredSignals(const SignalMap& map) {
  ids_.fill(-1);
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    if (!map.hasOwnWire(signal)) continue;
    ids_.at(i) = static_cast<int>(signals_.size());
    if (!isSensor(signal)) outputs_.push_back({*map.pin(signal), ids_.at(i)});
    signals_.push_back(signal);
  }
  levels_.resize(signals_.size());
}

std::optional<int> WiredSignals::idOf(Signal signal) const {
  const int id = ids_.at(static_cast<std::size_t>(signal));
  return id < 0 ? std::nullopt : std::optional(id);
}

void WiredSignals::takeEvent(const PinEvent& event, std::vector<PinEdge>& edges) {
  for (const Wire& wire : outputs_) {
    if (wire.pin.port != event.port) continue;
    const bool level = (event.level >> wire.pin.bit & 1U) != 0;
    const auto index = static_cast<std::size_t>(wire.id);
    if (level == levels_[index]) continue;
    levels_[index] = level;
    edges.push_back({event.tick, wire.id, level});
  }
}

std::vector<PinEdge> WiredSignals::edgesOf(std::span<const PinEvent> events,
                                           std::span<const SensorEdge> sensors) {
  std::vector<PinEdge> edges;
  auto sensor = sensors.begin();
  const auto sensorsBefore = [&](Tick tick, bool all) {
    for (; sensor != sensors.end() && (all || sensor->tick < tick); ++sensor) {
      const int id = ids_.at(static_cast<std::size_t>(sensor->signal));
      if (id < 0 || levels_[static_cast<std::size_t>(id)] == sensor->level) continue;
      levels_[static_cast<std::size_t>(id)] = sensor->level;
      edges.push_back({sensor->tick, id, sensor->level});
    }
  };
  for (const PinEvent& event : events) {
    sensorsBefore(event.tick, false);
    takeEvent(event, edges);
  }
  sensorsBefore(0, true);
  return edges;
}

void PinBatch::add(const PinEdge& edge) {
  if (empty()) tick0_ = last_ = edge.tick;
  dt_.add(static_cast<std::int64_t>(edge.tick - last_));
  id_.add(edge.id);
  level_.add(edge.level ? 1 : 0);
  last_ = edge.tick;
}

std::string PinBatch::take() {
  std::string text = "{\"tick0\":";
  appendInteger(text, static_cast<std::int64_t>(tick0_));
  appendColumn(text, "dt", dt_);
  appendColumn(text, "id", id_);
  appendColumn(text, "level", level_);
  text.push_back('}');
  for (JsonColumn* column : {&dt_, &id_, &level_}) column->clear();
  return text;
}

}  // namespace kerfbench::trace
