// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/source/mcs51_child/cpu.h"
#include "hil/source/mcs51_child/interrupts.h"
#include "hil/source/mcs51_child/part.h"
#include "hil/source/mcs51_child/pin_sampler.h"
#include "hil/source/mcs51_child/ports.h"
#include "hil/source/mcs51_child/sfr.h"
#include "hil/source/mcs51_child/timers.h"
#include "hil/source/mcs51_child/uart.h"

namespace kerfbench::mcs51_child {

/// A whole controller, one instruction after the other.
///
/// Instructions are carried out by execute(), as long as nothing happens outside; what does happen until the
/// end of the last one, and the interrupt that may follow, by settle(). In between, inputs take effect. A
/// port changes in S1P1 after the last cycle of its instruction (Intel 1994): events have the tick at which
/// the instruction ends.
class Chip : private Peripherals {
 public:
  /// `code` has the size of the part's code memory. Power comes at tick 0; ports show it at tick 1.
  Chip(const Part& part, const std::vector<std::uint8_t>& code, std::size_t max_events);

  /// Carries out the next instruction, and those behind it until one ends at `limit` or later, or settle()
  /// has something to do; an idle controller waits.
  void execute(Tick limit);
  /// execute() and settle() by turns, until an instruction or the call of an interrupt has ended at `limit`
  /// or later, the UART has begun or heard a frame, or nothing can go on. @pre No input is due before
  /// `limit`. Returns whether all is settled.
  bool run(Tick limit);
  /// After execute(), and again after each call: peripherals catch up, and an interrupt is entered if one is
  /// due. Returns whether one was, which takes the time of a call.
  bool settle() {
    const bool is_quiet = next_ > now_ && !is_reset_due_ && !cpu_.hasReturned() && !interrupts_.hasPending();
    return !is_quiet && settleDue();
  }
  /// A level on a pin from outside. @pre `tick` is not before the last one. Before settle().
  void drive(unsigned port, unsigned bit, bool level, Tick tick);

  /// The end of the last instruction.
  [[nodiscard]] Tick now() const { return now_; }
  [[nodiscard]] const std::string& fault() const { return cpu_.fault(); }
  /// Why nothing can happen any more; empty else.
  [[nodiscard]] const std::string& end() const { return end_; }
  [[nodiscard]] Cpu& cpu() { return cpu_; }
  [[nodiscard]] Ports& ports() { return ports_; }
  [[nodiscard]] Uart& uart() { return uart_; }
  [[nodiscard]] const Uart& uart() const { return uart_; }
  [[nodiscard]] Sfrs& sfrs() { return sfrs_; }
  /// A frame on the line, see Uart::hear().
  void hear(const Frame& frame);
  /// As an instruction would, at this moment; for tests.
  std::uint8_t peekSfr(std::uint8_t address) { return readSfr(address, true); }
  void pokeSfr(std::uint8_t address, std::uint8_t value);

 private:
  std::uint8_t readSfr(std::uint8_t address, bool is_latch) override;
  void writeSfr(std::uint8_t address, std::uint8_t value) override;
  void writeSfrBit(std::uint8_t address, std::uint8_t mask, bool on) override;
  void writeRegister(std::uint8_t address, std::uint8_t value);
  void writePort(unsigned port, std::uint8_t value);
  bool writeStcPortMode(std::uint8_t address, std::uint8_t value);
  void writeFlags(std::uint8_t address, std::uint8_t value);
  void writeControl(std::uint8_t address, std::uint8_t value);
  void writePowerControl(std::uint8_t value);
  void feedWatchdog(std::uint8_t value);
  [[nodiscard]] int portAt(std::uint8_t address) const;

  bool settleDue();
  void reset(Tick tick);
  void advance(Tick tick);
  void refreshNext();
  void pinsChanged(Tick tick);
  void applySample(const PinSampler::Sample& sample);
  void followLevels(Tick tick);
  void wait(Tick limit);
  void sleep(Tick limit);
  void wakeUp();

  const Part& part_;
  const ClockTable& clocks_;
  Sfrs sfrs_;
  Ports ports_;
  Interrupts interrupts_;
  Timers timers_;
  Uart uart_;
  PinSampler sampler_;
  Cpu cpu_;
  Tick now_{};
  Tick next_{};
  Tick watchdog_{kNever};
  Tick stopped_at_{};
  bool is_reset_due_{};
  std::uint8_t watchdog_key_{};
  std::string end_;
};

}  // namespace kerfbench::mcs51_child
