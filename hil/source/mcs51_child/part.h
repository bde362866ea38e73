// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace kerfbench::mcs51_child {

/// Clocks of the oscillator that each opcode takes.
using ClockTable = std::array<std::uint8_t, 256>;

/// Twelve clocks a machine cycle, one, two or four machine cycles an instruction (Intel 1994).
const ClockTable& twelveClocks();
/// One clock a machine cycle: the core STC-Y5 of the series STC15 (STC 2015, table of instructions).
const ClockTable& stc15Clocks();

/// What is known of a controller.
struct Part {
  std::string_view names;      ///< With blanks between them.
  bool is_stc15{};             ///< Else an 8051 or 8052 of twelve clocks a machine cycle.
  std::uint32_t code_bytes{};  ///< At most 65 536.
  std::uint32_t iram_bytes{};  ///< Internal RAM: 128 or 256.
  std::uint32_t xram_bytes{};  ///< What MOVX reaches.
  std::uint8_t ports{};        ///< A bit for each port that is led out.
  bool has_timer2{};           ///< The 8052's. The STC15 has one of its own.
  bool has_clock_out{};        ///< T2MOD: timer 2 puts a clock on P1.0.
  bool has_watchdog{};         ///< WDTRST of the AT89S series.
  bool has_second_dptr{};
  std::array<std::uint8_t, 6> listens_after_reset{};  ///< Bits of ports that a reset leaves as inputs (PxM1).
  bool wakes_by_interrupt{};                          ///< INT0 and INT1 end power-down.

  /// Clocks of a machine cycle.
  [[nodiscard]] unsigned cycle() const { return is_stc15 ? 1 : 12; }
  [[nodiscard]] const ClockTable& clocks() const { return is_stc15 ? stc15Clocks() : twelveClocks(); }
  [[nodiscard]] bool isCalled(std::string_view name) const;
  [[nodiscard]] std::string firstName() const;
};

std::span<const Part> parts();

/// @throws std::runtime_error if no part is called so.
const Part& partCalled(std::string_view name);

/// The part of this name, or all where none is called so, a line each: names with blanks between them, tab,
/// bytes of code memory, tab, of internal RAM and XRAM, tab, of EEPROM, tab, digits of its ports, tab, of its
/// timers, tab, of its UARTs.
std::string describeControllers(const std::string& name);

}  // namespace kerfbench::mcs51_child
