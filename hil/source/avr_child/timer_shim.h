// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <avr_timer.h>
#include <sim_avr.h>

#include <array>
#include <cstdint>

#include "hil/source/avr_child/pins.h"

namespace kerfbench::avr_child {

/// Makes one of simavr 1.6's timers behave as the silicon in the points that pulse-making firmware relies on:
///
/// - a CTC timer whose TOP is 0 matches at every clock (simavr never starts it);
/// - a count written, or left behind, while the clock is stopped is where the timer goes on (simavr starts
/// from 0), and a
///   change of prescaler or mode keeps the count;
/// - a written count is exact (simavr rounds it by up to 7 cycles at a prescaler of 8);
/// - enabling an interrupt whose flag is set raises it;
/// - ICRn as TOP takes effect when it is written;
/// - compare outputs own their pins without touching PORT, and in fast PWM the compare register is
/// double-buffered, so
///   that a new duty makes no glitch, TOP means always high and 0 means one clock.
///
/// Not modelled better than simavr does: phase-correct PWM (simavr counts up only), fast PWM with OCRnA as
/// TOP, and a compare value written below the running count (silicon runs on to MAX, simavr matches at once).
class TimerShim {
 public:
  TimerShim(avr_t* avr, avr_timer_t* timer, Pins& pins);
  TimerShim(const TimerShim&) = delete;
  TimerShim& operator=(const TimerShim&) = delete;

  /// Whether a write to this register concerns the timer.
  [[nodiscard]] bool watches(avr_io_addr_t addr) const;
  void beforeWrite(avr_io_addr_t addr);
  void afterWrite(avr_io_addr_t addr);
  /// Call after every reset, including the first: simavr has connected its compare units to the pins again.
  void afterReset();
  void setCountWriter(avr_io_write_t writer, void* param) {
    write_count_ = writer, write_count_param_ = param;
  }
  void setControlWriter(avr_io_write_t writer, void* param) {
    write_control_ = writer, write_control_param_ = param;
  }
  [[nodiscard]] avr_io_addr_t countRegister() const { return timer_->r_tcnt; }
  [[nodiscard]] avr_io_addr_t controlRegister() const {
    return static_cast<avr_io_addr_t>(timer_->cs[0].reg);
  }
  /// False: a stopped counter must be read from its register, where simavr would answer 0.
  [[nodiscard]] bool running() const { return clockSelect() != 0; }

 private:
  struct Output {
    TimerShim* owner{};
    avr_timer_comp_t* comp{};
    unsigned index{};
    int port{-1};
    bool level{};
  };
  static void onCompare(avr_irq_t* irq, std::uint32_t value, void* param);
  static avr_cycle_count_t onBottom(avr_t* avr, avr_cycle_count_t when, void* param);
  static avr_cycle_count_t onMatch(avr_t* avr, avr_cycle_count_t when, void* param);
  static avr_cycle_count_t onZeroTop(avr_t* avr, avr_cycle_count_t when, void* param);

  [[nodiscard]] unsigned clockSelect() const;
  [[nodiscard]] unsigned mode() const;
  [[nodiscard]] bool internalClock() const;
  [[nodiscard]] bool fastPwm() const;
  [[nodiscard]] bool zeroTop() const;
  [[nodiscard]] std::uint32_t compareValue(const avr_timer_comp_t& comp) const;
  [[nodiscard]] std::uint16_t count() const;
  void setCount(std::uint16_t value);
  void makeCountExact(std::uint16_t value);
  void raiseEnabled();
  void raiseZeroTop();
  void followPwm();
  void show(Output& output);

  avr_t* avr_;
  avr_timer_t* timer_;
  Pins& pins_;
  std::array<Output, AVR_TIMER_COMP_COUNT> outputs_;
  avr_io_write_t write_count_{};
  void* write_count_param_{};
  avr_io_write_t write_control_{};
  void* write_control_param_{};
  unsigned select_before_{};
  unsigned mode_before_{};
  std::uint16_t count_before_{};
  bool pwm_running_{};
};

}  // namespace kerfbench::avr_child
