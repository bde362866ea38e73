// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/core_time.h"

#include <cmath>
#include <numeric>

namespace kerfbench::cortex_m_child {
namespace {

__extension__ using Wide = unsigned __int128;

}  // namespace

CoreTime::CoreTime(std::uint64_t clock_hz, std::uint64_t core_hz) : clock_hz_(clock_hz) { setRatio(core_hz); }

void CoreTime::setRatio(std::uint64_t core_hz) {
  core_hz_ = core_hz;
  const std::uint64_t common = std::gcd(clock_hz_, core_hz);
  ticks_ = clock_hz_ / common;
  cycles_ = core_hz / common;
}

void CoreTime::changeClock(Cycle now, std::uint64_t core_hz) {
  const Wide parts = static_cast<Wide>(now - base_cycle_) * ticks_ + base_part_;
  base_tick_ += static_cast<std::uint64_t>(parts / cycles_);
  const auto rest = static_cast<std::uint64_t>(parts % cycles_);
  const std::uint64_t parts_before = cycles_;
  base_cycle_ = now;
  setRatio(core_hz);
  base_part_ = static_cast<std::uint64_t>(static_cast<Wide>(rest) * cycles_ / parts_before);
}

std::uint64_t CoreTime::tickOf(Cycle cycle) const {
  if (ticks_ == cycles_) return base_tick_ + (cycle - base_cycle_);
  const Wide parts = static_cast<Wide>(cycle - base_cycle_) * ticks_ + base_part_;
  return base_tick_ + static_cast<std::uint64_t>(parts / cycles_);
}

Cycle CoreTime::cycleAt(std::uint64_t tick) const {
  if (tick <= base_tick_) return base_cycle_;
  if (ticks_ == cycles_) return base_cycle_ + (tick - base_tick_);
  const Wide parts = static_cast<Wide>(tick - base_tick_) * cycles_ - base_part_;
  return base_cycle_ + static_cast<Cycle>((parts + ticks_ - 1) / ticks_);
}

Cycle CoreTime::cyclesIn(double seconds) const {
  return static_cast<Cycle>(std::ceil(seconds * static_cast<double>(core_hz_)));
}

}  // namespace kerfbench::cortex_m_child
