// SPDX-License-Identifier: GPL-3.0-or-later
// The AVR release under simavr, its pins watched and its interrupts timed in cycles. Linked with simavr,
// hence the licence.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <sim_avr.h>

#include "firmware_under_test/controller/protocol.h"
#include "firmware_under_test/planner/program/link.h"
#include "hil/source/avr_child/core.h"
#include "no_field.h"

namespace kerfbench::avr_bench {

inline constexpr std::uint64_t kByteCycles = 640;
inline constexpr std::uint64_t kNever = ~0ULL;

struct Axis {
  char port;
  int pul, dir;
  long position{}, steps{};
  std::uint64_t rise{kNever}, fall{kNever}, dir_change{kNever};
  std::uint64_t min_setup{kNever}, min_hold{kNever}, min_width{kNever}, max_width{}, min_space{kNever};
};

/// Times of one interrupt: simavr reports when a vector is requested, starts and ends.
struct Vector {
  int number;
  const char* name;
  std::uint64_t asked{kNever}, entry{kNever};
  /// Statistics; latest: longest time from request to start.
  std::uint64_t count{}, sum{}, longest{}, latest{};
};

struct Bench {
  avr_t* avr{};
  std::unique_ptr<avr_child::Core> core;
  std::array<Axis, KB_AXES> axes{{{'A', 0, 1}, {'A', 2, 3}, {'A', 4, 5}, {'A', 6, 7}, {'C', 0, 1}}};
  std::array<Vector, 5> vectors{{{17, "tick (TIMER1_COMPA)"},
                                 {3, "encoder (INT2)"},
                                 {4, "print mark (INT3)"},
                                 {25, "UART (USART0_RX)"},
                                 {18, "tick that holds pulses (TIMER1_COMPB)"}}};
  std::array<unsigned, 256> levels{};  ///< Levels as the drives understand them, after the inversion.
  unsigned invert_a{}, invert_c{};     ///< Inversions; set before load().
  std::deque<std::uint8_t> to_controller;
  std::vector<std::uint8_t> from_controller;
  avr_irq_t* rx{};
  bool xoff{};
  std::uint64_t bytes{};
  std::uint64_t first_tick{kNever}, min_interval{kNever}, max_interval{}, ticks{};
  /// Times from the last change of DIR in a tick to the tick's end, and from a tick's begin to an edge of
  /// PUL.
  std::uint64_t min_tail{kNever}, min_head{kNever}, min_gap{kNever}, tick_end{kNever};
  std::uint64_t encoder_period{}, gate_rise{}, gate_fall{}, mark_rise{};
  unsigned quadrature{};
  bool running{};
  bool busy_wire{true};
  bool cut_line{};                              ///< True if nothing of the host arrives.
  int resets{};                                 ///< Number of resets by the watchdog.
  void (*on_step)(Bench&, std::size_t axis){};  ///< Handler of each active edge.
  void (*on_count)(Bench&){};  ///< Handler before each count of the encoder; may change encoder_period.
  void* context{};

  [[nodiscard]] Vector& tick() { return vectors[0]; }
};

void driveInput(Bench& bench, char port, int bit, unsigned level);
/// Loads an Intel hex image into a controller whose guard is closed and whose limits are free. Ends the
/// program if it cannot be read. One bench at a time; unload() before the next.
void load(Bench& bench, const char* image);
void unload(Bench& bench);
/// Starts the belt at `cycle`, a count each bench.encoder_period.
void startBelt(Bench& bench, std::uint64_t cycle);
void raiseMarkAt(Bench& bench, std::uint64_t cycle);
/// Runs to that cycle. Ends the program if the emulator says that the firmware crashed.
void runTo(Bench& bench, std::uint64_t cycle);
/// Runs to that cycle, then passes bytes to the host and takes its answer; returns the number of bytes it
/// sends.
std::size_t serve(Bench& bench, planner::Link& link, std::uint64_t cycle);
void putU32(std::vector<std::uint8_t>& to, std::uint32_t value);
/// Prints "ok" or "FAIL" and `what`; counts failures.
void check(bool good, const std::string& what);
int failures();

}  // namespace kerfbench::avr_bench
