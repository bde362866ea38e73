// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hil/source/mcs51_child/counter.h"
#include "hil/source/mcs51_child/interrupts.h"
#include "hil/source/mcs51_child/part.h"
#include "hil/source/mcs51_child/pin_sampler.h"
#include "hil/source/mcs51_child/ports.h"
#include "hil/source/mcs51_child/sfr.h"

namespace kerfbench::mcs51_child {

/// Timers 0, 1 and 2 (Intel 1994, chapter 3; STC 2015, chapter on timers).
///
/// A timer counts in S3P1 of each machine cycle and flags an overflow in S5P2 of the same cycle. What
/// software writes to it takes effect in S6P2 of the last cycle of the instruction, what it reads was fetched
/// behind the counting of the instruction's first cycle (its address comes in S4).
class Timers {
 public:
  Timers(const Part& part, Sfrs& sfrs, Interrupts& interrupts, Ports& ports);

  void reset(Tick tick);
  /// Does what is due until `tick`, included.
  void advance(Tick tick);
  /// When something is due next: a flag is set, or a clock output changes.
  [[nodiscard]] Tick next() const;

  /// Counts. @pre advance() has been called.
  [[nodiscard]] std::uint8_t read(std::uint8_t address) const;
  /// A count, or a reload value, is written. @pre advance() has been called.
  void write(std::uint8_t address, std::uint8_t value);
  /// A control register (TCON, TMOD, T2CON, T2MOD, AUXR) has changed. @pre as for write().
  void configure(Tick tick);
  /// Pins have changed.
  void sampled(const PinSampler::Sample& sample);
  /// The oscillator stands still, in power-down.
  void setStopped(bool is_stopped, Tick tick);

  /// The counter that clocks the UART, and how many of its overflows make a bit.
  struct BaudClock {
    const Counter* counter;
    unsigned overflows_per_bit;
  };
  [[nodiscard]] BaudClock transmitClock() const;
  [[nodiscard]] BaudClock receiveClock() const;

 private:
  /// Timer 0 or 1.
  struct Timer {
    Counter counter;
    std::uint8_t mode{};
    std::uint8_t high{};     // TH where it does not count with TL.
    std::uint8_t upper{};    // Bits 5 to 7 of TL in mode 0, which do not count.
    std::uint16_t reload{};  // What the STC15's mode 0 starts from.
    bool counts_edges{};
  };
  [[nodiscard]] std::uint8_t low(const Timer& timer) const;
  [[nodiscard]] std::uint8_t high(const Timer& timer) const;
  void setMode(Timer& timer, std::uint8_t mode);
  void put(Timer& timer, std::uint8_t low, std::uint8_t high);
  void writeStcReload(Timer& timer, bool is_high, std::uint8_t value, bool runs);
  [[nodiscard]] bool reloadsSixteenBits(const Timer& timer) const;
  void configureTimer(unsigned index, Tick tick);
  void configureTimer2(Tick tick);
  void configureStcTimer2(Tick tick);
  void advanceCounter(Counter& counter, Tick tick, std::uint8_t tcon_flag, Interrupt source);
  void advanceTimer2(Tick tick);
  void overflowTimer2(Tick tick);
  void writeTimer2(std::uint8_t address, std::uint8_t value);
  [[nodiscard]] std::uint8_t countedPins() const;
  void sampleForTimer2(const PinSampler::Sample& sample);
  [[nodiscard]] bool isTimer2Watched() const;
  [[nodiscard]] Tick nextOfTimer2() const;
  [[nodiscard]] bool splits() const;  // Timer 0 in mode 3.
  [[nodiscard]] bool isTimer2Baud() const { return (sfrs_[kT2con] & (kRclk | kTclk)) != 0; }
  [[nodiscard]] bool isClockOut() const;
  [[nodiscard]] BaudClock baudClock(std::uint8_t timer2_bit) const;

  const Part& part_;
  Sfrs& sfrs_;
  Interrupts& interrupts_;
  Ports& ports_;
  Timer timers_[2];
  Counter split_;  // TH0 in mode 3 of timer 0.
  Counter timer2_;
  std::uint8_t levels_{0x3F};
  bool is_stopped_{};
  bool clock_output_low_{};
  Tick advanced_to_{};
};

}  // namespace kerfbench::mcs51_child
