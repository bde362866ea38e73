// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "hil/scenario/provoke_choice.h"
#include "twin/base/pin_event.h"

namespace kerfbench::run {

/// Does to sensors and line what is to be provoked. Deterministic.
class Provocation {
 public:
  Provocation(const scenario::ProvokeChoice& choice, TickRate rate, std::uint64_t seed);

  /// Edges of the twin's sensors in (from, until], by tick, as they reach the controller.
  void changeSensors(std::vector<SensorEdge>& edges, Tick from, Tick until) const;
  /// Bytes that the host sends now, as they reach the controller.
  std::vector<std::uint8_t> toController(std::vector<std::uint8_t> bytes, double now_s);
  /// When it came about on the line; NaN before.
  [[nodiscard]] double lineCut_s() const { return line_cut_s_; }

 private:
  scenario::ProvokeChoice choice_;
  Tick at_;
  Tick flicker_;
  Tick closed_again_;
  std::mt19937 random_;
  double line_cut_s_;
};

}  // namespace kerfbench::run
