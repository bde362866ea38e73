// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hil/source/cortex_m_child/memory_map.h"

namespace kerfbench::cortex_m_child {

/// Ticks of the pin stream, in which a second has as many as the scenario says, and cycles of the core, whose
/// clock the firmware sets: 9 ticks are a cycle of 8 MHz where the scenario says 72 MHz.
class CoreTime {
 public:
  /// @param clock_hz ticks in a second. The core begins with core_hz.
  CoreTime(std::uint64_t clock_hz, std::uint64_t core_hz);

  /// From this cycle on the core has another clock.
  void changeClock(Cycle now, std::uint64_t core_hz);
  /// The tick in which a cycle begins.
  [[nodiscard]] std::uint64_t tickOf(Cycle cycle) const;
  /// The first cycle that begins at a tick or after it.
  [[nodiscard]] Cycle cycleAt(std::uint64_t tick) const;
  /// Cycles in a time, rounded up.
  [[nodiscard]] Cycle cyclesIn(double seconds) const;
  [[nodiscard]] std::uint64_t clockHz() const { return clock_hz_; }
  [[nodiscard]] std::uint64_t coreHz() const { return core_hz_; }

 private:
  void setRatio(std::uint64_t core_hz);

  std::uint64_t clock_hz_;
  std::uint64_t core_hz_{};
  std::uint64_t ticks_{};  ///< In as many cycles as cycles_.
  std::uint64_t cycles_{};
  Cycle base_cycle_{};
  std::uint64_t base_tick_{};
  std::uint64_t base_part_{};  ///< What base_cycle_ is after base_tick_, in 1/cycles_ of a tick.
};

}  // namespace kerfbench::cortex_m_child
