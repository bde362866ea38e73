// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/trace/json_text.h"
#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"

namespace kerfbench::trace {

/// An edge of a wired signal.
struct PinEdge {
  Tick tick{};
  int id{};  ///< Index in WiredSignals.
  bool level{};
};

/// The signals of a machine that have a wire of their own, numbered as /machine lists them; all are low at
/// first.
class WiredSignals {
 public:
  explicit WiredSignals(const SignalMap& map);
  [[nodiscard]] const std::vector<Signal>& signals() const { return signals_; }
  [[nodiscard]] std::optional<int> idOf(Signal signal) const;

  /// Edges of controller and sensors of a span of time, by tick; of equal ticks those of the controller
  /// first. An event or edge that leaves a level as it is gives none.
  std::vector<PinEdge> edgesOf(std::span<const PinEvent> events, std::span<const SensorEdge> sensors);

 private:
  void takeEvent(const PinEvent& event, std::vector<PinEdge>& edges);

  struct Wire {
    PinId pin;
    int id{};
  };
  std::vector<Signal> signals_;
  std::vector<Wire> outputs_;
  std::array<int, kSignalCount> ids_{};  ///< -1: not wired.
  std::vector<bool> levels_;
};

/// A message of /pins in the making.
class PinBatch {
 public:
  void add(const PinEdge& edge);
  [[nodiscard]] bool empty() const { return dt_.empty(); }
  [[nodiscard]] Tick tick0() const { return tick0_; }
  std::string take();

 private:
  JsonColumn dt_, id_, level_;
  Tick tick0_{}, last_{};
};

}  // namespace kerfbench::trace
