// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hil/source/mcs51_child/part.h"
#include "hil/source/mcs51_child/sfr.h"

namespace kerfbench::mcs51_child {

/// Sources of interrupts, in the order in which they are polled.
enum class Interrupt : std::uint8_t { kExternal0, kTimer0, kExternal1, kTimer1, kSerial, kTimer2 };
inline constexpr std::size_t kInterrupts = 6;

/// Interrupts with two priorities (Intel 1994, "Interrupts" of chapter 3).
///
/// Flags are sampled in S5P2 of each machine cycle, and the samples polled in the next one. A call follows if
/// the polling cycle is the last one of its instruction, if no interrupt of the same or a higher priority is
/// in progress, and if the instruction is neither RETI nor a write to IE or IP. So an instruction that ends
/// at `end` is interrupted by what was flagged in the machine cycle before its last one, or earlier. Timer
/// 2 flags in S2P2 and is polled in the same cycle.
class Interrupts {
 public:
  Interrupts(const Part& part, Sfrs& sfrs) : part_(part), sfrs_(sfrs) {}
  void reset();

  /// The flag of a source is set in the machine cycle that ends at `tick`; one that is set already stays as
  /// old as it is.
  void flag(Interrupt source, Tick tick);
  /// Software has written the register with flags of these sources: what it sets is sampled in the cycle
  /// after `tick`, where its instruction ends.
  void written(Tick tick);
  /// Software writes IE or IP, or RETI is carried out: the next poll is of no effect.
  void inhibit() { is_inhibited_ = true; }
  void returned();
  /// Enables, priorities or flags have changed.
  void refresh();

  /// Whether an enabled request waits; a quick word, to be asked after each instruction.
  [[nodiscard]] bool hasPending() const { return pending_ != 0 || held_ != 0 || is_inhibited_; }
  /// Keeps what would be polled at the end of the instruction that ends at `end`, before it clears a flag.
  void hold(Tick end) { held_ = static_cast<std::uint8_t>(held_ | visible(end)); }
  /// Polls at the end of an instruction. The source to be served, whose flag is cleared if hardware does so.
  std::optional<Interrupt> poll(Tick end);
  /// The first tick at which an idle controller, which does nothing but poll, is interrupted; kNever if only
  /// something new can.
  [[nodiscard]] Tick nextWake() const;
  /// Whether anything is enabled that could ever interrupt.
  [[nodiscard]] bool isAnyEnabled() const { return enabled() != 0; }

  [[nodiscard]] std::uint16_t vectorOf(Interrupt source) const;
  /// Flags of all sources, a bit each.
  [[nodiscard]] std::uint8_t requests() const;

 private:
  [[nodiscard]] std::uint8_t enabled() const;
  [[nodiscard]] std::uint8_t highPriority() const;
  [[nodiscard]] std::uint8_t visible(Tick end) const;
  [[nodiscard]] std::uint8_t unblocked() const;
  void acknowledge(Interrupt source);

  const Part& part_;
  Sfrs& sfrs_;
  std::array<Tick, kInterrupts> since_{};  // End of the cycle in which the flag was sampled.
  std::uint8_t pending_{};
  std::uint8_t held_{};
  std::uint8_t flagged_{};  // requests() as of the last change.
  bool stc_timer2_{};       // The STC15's timer 2 has a flag that no register shows.
  bool is_inhibited_{};
  std::array<bool, 2> in_progress_{};
};

}  // namespace kerfbench::mcs51_child
