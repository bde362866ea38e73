// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hil/source/signal_source.h"
#include "twin/base/signal_map.h"

namespace own {

/// Source of one's own: no firmware at all, but a generator that steps a mirror to and fro with the laser on,
/// and once stands still under light. It takes the place of an emulator, a recording or real pins.
class PatternSource final : public kerfbench::source::SignalSource {
 public:
  /// `map`: the machine's wiring, in which the first mirror or the gantry's x, gate and PWM have pins.
  /// `rest_s`: time for which the beam stands under light; >= 0.
  /// @throws std::invalid_argument for a machine without such pins.
  PatternSource(const kerfbench::SignalMap& map, double rest_s);

  [[nodiscard]] kerfbench::source::SourceInfo info() const override;
  kerfbench::source::Stop advance(kerfbench::Tick until, kerfbench::source::Batch& batch) override;
  /// The pattern listens to nobody.
  void drive(kerfbench::PinId, bool, kerfbench::Tick) override {}
  void uartWrite(std::span<const std::uint8_t>) override {}
  [[nodiscard]] std::string message() const override { return "the pattern is at its end"; }

 private:
  void toggle(kerfbench::Signal signal, double time_s);

  kerfbench::SignalMap map_;
  std::vector<kerfbench::PinEvent> events_;  ///< All of them, by tick.
  std::size_t next_{};
  std::vector<std::uint16_t> levels_;  ///< Levels of each port so far.
};

}  // namespace own
