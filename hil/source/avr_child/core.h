// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "hil/source/avr_child/processor.h"

namespace kerfbench::avr_child {

/// Gives a controller of simavr memories as large as its addresses reach, with zeros where it has none:
/// simavr reads and writes wherever a firmware wants to.
void boundMemories(avr_t& avr);

/// Carries out instructions in place of simavr's avr_run_one(), on simavr's controller: its memories,
/// registers and callbacks, interrupts and timers.
///
/// Each instruction is decoded once, by the tables of the manual (Atmel 2016), into an operation; operations
/// follow one another until something else is due. What is rare is left to simavr: SLEEP, BREAK, SPM, codes
/// that are no instruction, and accesses and jumps to where the controller has no memory.
class Core {
 public:
  /// The controller's flash is loaded.
  explicit Core(avr_t* avr) : p_(avr) {}

  /// Runs one instruction, and more until one would begin at `limit`, or at simavr's next timer, or later.
  /// Ends as well after an instruction that is left to simavr, that ends with an interrupt waiting, or in
  /// which a callback has set avr_t::run_cycle_count to 0. avr_t::run_cycle_limit must be 1.
  void run(Cycle limit);
  /// The flash has changed behind the core's back.
  void forgetCode(std::uint32_t pc, std::uint32_t bytes) { p_.forgetCode(pc, bytes); }

 private:
  Processor p_;
};

}  // namespace kerfbench::avr_child
