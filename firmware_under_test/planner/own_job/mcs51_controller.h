// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "firmware_under_test/planner/job/target.h"

namespace kerfbench::planner {

/// Pin of an 8051's ports 0 to 3, as "P1.0".
struct Mcs51Pin {
  int port{}, bit{};
  [[nodiscard]] std::string name() const;
  /// Address in the space of bits.
  [[nodiscard]] int address() const { return 0x80 + 16 * port + bit; }
  friend bool operator==(const Mcs51Pin&, const Mcs51Pin&) = default;
};

/// Controller that holds its job, and what is wired to it besides the drives, which are at P1.0 to P1.3.
struct Mcs51Controller {
  std::string mcu{"at89s52"};
  double clock_hz{24e6};
  double tick_s{};  ///< Length of a tick; 0: the shortest.
  std::string gate_pin{"P1.4"}, pwm_pin{"P1.5"};
  std::string start_pin{"P3.2"}, mark_pin{"P3.3"}, guard_pin{"P3.4"};  ///< High while active.
  bool gate_low{true};  ///< The laser may emit while its gate is low: a reset leaves all pins high.
  bool pwm_low{true};   ///< The power is the share of low of the PWM.
};

/// What the control program needs of a part and gets of its time.
struct Mcs51Account {
  std::size_t code_bytes{};     ///< Size of the code memory.
  std::size_t program_bytes{};  ///< Share of the control program without its job, at most.
  int tick_clocks{};            ///< Clocks of the longest tick.
  int timer_counts{};     ///< Length of a tick in counts of timer 0, which are 12 clocks each; 1 … 256.
  bool has_port_modes{};  ///< Pins are to be made bidirectional after a reset.
  Target target{};        ///< What a job is planned for.
};

/// Checks a controller and gives its account. @throws PlanError with all that is wrong, and what would fit.
Mcs51Account accountOf(const Mcs51Controller& controller);
/// @throws PlanError for a text that names no pin of ports 0 to 3.
Mcs51Pin pinFrom(std::string_view name);
/// Names of the parts whose code memory has as many bytes; "none that is known" if there is none.
std::string partsWith(std::size_t code_bytes);

}  // namespace kerfbench::planner
