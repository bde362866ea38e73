// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "hil/source/mcs51_child/sfr.h"

namespace kerfbench::mcs51_child {

/// Pins that peripherals look at, as masks of their levels.
inline constexpr std::uint8_t kInt0Pin = 0x01, kInt1Pin = 0x02, kT0Pin = 0x04, kT1Pin = 0x08, kT2Pin = 0x10,
                              kT2exPin = 0x20;

/// Samples pins once in each machine cycle, in S5P2 (Intel 1994): a pulse between two samples is not seen.
class PinSampler {
 public:
  /// What one sample shows.
  struct Sample {
    Tick tick{};  ///< End of the machine cycle.
    std::uint8_t levels{};
    std::uint8_t fallen{}, risen{};
  };

  explicit PinSampler(unsigned cycle) : cycle_(cycle), phase_(cycle == 12 ? 9 : 0) {}

  /// The pins have these levels from `tick` on. Returns an older sample that has not been taken yet.
  std::optional<Sample> change(std::uint8_t levels, Tick tick) {
    if (levels == pending_) return std::nullopt;
    const std::uint64_t index = tick <= phase_ ? 0 : (tick - phase_ + cycle_ - 1) / cycle_;
    std::optional<Sample> older;
    if (is_pending_ && index_ < index) older = commit();
    pending_ = levels;
    index_ = index;
    is_pending_ = true;
    return older;
  }
  /// End of the cycle whose sample shows something new; kNever if there is none.
  [[nodiscard]] Tick next() const { return is_pending_ ? (index_ + 1) * cycle_ : kNever; }
  Sample commit() {
    is_pending_ = false;
    const auto old = static_cast<std::uint8_t>(sampled_);
    sampled_ = pending_;
    return {(index_ + 1) * cycle_, sampled_, static_cast<std::uint8_t>(old & ~sampled_),
            static_cast<std::uint8_t>(sampled_ & ~old)};
  }
  [[nodiscard]] std::uint8_t levels() const { return sampled_; }

 private:
  unsigned cycle_;
  unsigned phase_;
  std::uint8_t sampled_{0x3F};
  std::uint8_t pending_{0x3F};
  std::uint64_t index_{};
  bool is_pending_{};
};

}  // namespace kerfbench::mcs51_child
