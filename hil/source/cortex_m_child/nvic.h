// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>

namespace kerfbench::cortex_m_child {

/// Numbers of exceptions in the vector table (ARM 2010, Exception types).
inline constexpr unsigned kHardFault = 3, kMemManage = 4, kBusFault = 5, kUsageFault = 6, kSvCall = 11,
                          kPendSv = 14, kSysTick = 15, kFirstInterrupt = 16;
inline constexpr unsigned kInterrupts = 60;  ///< The lines of a high-density part.

/// Nested vectored interrupt controller: who is pending, who is active, who comes next (ARMv7-M 2010, B1.5).
/// Priorities have the four bits that the STM32F103 implements.
class Nvic {
 public:
  Nvic() { reset(); }
  void reset();

  /// A line of a device. One that is still up when its exception has returned is pending again.
  void setLine(unsigned interrupt, bool is_up);
  void pend(unsigned exception);
  void clearPending(unsigned exception) { pending_[exception] = false; }
  [[nodiscard]] bool isPending(unsigned exception) const { return pending_[exception]; }
  /// The pending exception that pre-empts what is being executed.
  [[nodiscard]] std::optional<unsigned> next() const;
  /// Whether one is pending that would pre-empt if PRIMASK did not mask it: what ends WFI.
  [[nodiscard]] bool wakes() const;
  /// Whether anything could ever become pending and end WFI.
  [[nodiscard]] bool canWake(bool ticks) const;
  /// Whether an exception of this number could pre-empt now.
  [[nodiscard]] bool canPreempt(unsigned exception) const;
  void activate(unsigned exception);
  void deactivate(unsigned exception);
  [[nodiscard]] bool isActive(unsigned exception) const { return active_[exception]; }
  [[nodiscard]] std::size_t activeExceptions() const { return active_.count(); }
  /// Whether HardFault or FAULTMASK leaves no place for another fault.
  [[nodiscard]] bool isLockedUpByFault() const { return executionPriority(true) < 0; }
  /// Whether anything became pending since the last call.
  [[nodiscard]] bool takeNews();

  /// Registers from 0xE000E100 on.
  [[nodiscard]] std::uint32_t read(std::uint32_t offset) const;
  void write(std::uint32_t offset, std::uint32_t value);
  [[nodiscard]] std::uint8_t priority(unsigned exception) const { return priority_[exception]; }
  void setPriority(unsigned exception, std::uint8_t value);
  void setEnabled(unsigned exception, bool is_enabled) { enabled_[exception] = is_enabled; }
  [[nodiscard]] bool isEnabled(unsigned exception) const { return enabled_[exception]; }

  unsigned priority_group{};  ///< PRIGROUP
  bool primask{};
  bool faultmask{};
  std::uint8_t basepri{};

 private:
  static constexpr unsigned kExceptions = kFirstInterrupt + kInterrupts;
  using Flags = std::bitset<kExceptions>;

  [[nodiscard]] int rawPriority(unsigned exception) const;
  [[nodiscard]] int groupPriority(unsigned exception) const;
  [[nodiscard]] int grouped(int priority) const;
  [[nodiscard]] int executionPriority(bool with_primask) const;
  [[nodiscard]] std::optional<unsigned> foremost() const;

  Flags enabled_, pending_, active_, lines_;
  std::array<std::uint8_t, kExceptions> priority_{};
  bool has_news_{};
};

}  // namespace kerfbench::cortex_m_child
