// SPDX-License-Identifier: GPL-3.0-or-later
#include "hil/source/avr_child/timer_shim.h"

#include <algorithm>
#include <vector>

namespace kerfbench::avr_child {
namespace {

constexpr unsigned kConnectedToggle = avr_timer_com_toggle;
constexpr unsigned kNonInverting = avr_timer_com_clear;

}  // namespace

TimerShim::TimerShim(avr_t* avr, avr_timer_t* timer, Pins& pins) : avr_(avr), timer_(timer), pins_(pins) {
  for (unsigned i = 0; i < outputs_.size(); ++i) {
    auto& output = outputs_[i];
    output = {this, &timer->comp[i], i, -1, false};
    if (output.comp->r_ocr != 0 && output.comp->com_pin.reg != 0) {
      output.port = pins.portOf(static_cast<avr_io_addr_t>(output.comp->com_pin.reg));
    }
    avr_irq_register_notify(timer->io.irq + TIMER_IRQ_OUT_COMP + i, onCompare, &output);
  }
}

void TimerShim::afterReset() {
  for (auto& output : outputs_) {
    auto* source = timer_->io.irq + TIMER_IRQ_OUT_COMP + output.index;
    source->flags = static_cast<std::uint8_t>(source->flags & ~static_cast<unsigned>(IRQ_FLAG_FILTERED));
    output.level = false;
    if (output.port < 0) continue;
    avr_ioport_getirq_t request{};
    request.bit = output.comp->com_pin;
    if (avr_ioctl(avr_, AVR_IOCTL_IOPORT_GETIRQ_REGBIT, &request) > 0)
      avr_unconnect_irq(source, request.irq[0]);
    pins_.setCompareOutput(output.port, output.comp->com_pin.bit, false, false);
  }
  pwm_running_ = false;
}

unsigned TimerShim::clockSelect() const { return avr_regbit_get_array(avr_, timer_->cs, 4); }
unsigned TimerShim::mode() const { return avr_regbit_get_array(avr_, timer_->wgm, 4); }

bool TimerShim::internalClock() const {
  const unsigned external = AVR_TIMER_EXTCLK_FLAG_TN | AVR_TIMER_EXTCLK_FLAG_AS2;
  return clockSelect() != 0 && (timer_->ext_clock_flags & external) == 0 && timer_->cs_div_value != 0;
}

bool TimerShim::fastPwm() const {
  return internalClock() && timer_->wgm_op_mode_kind == avr_timer_wgm_fast_pwm && timer_->tov_cycles > 1;
}

std::uint32_t TimerShim::compareValue(const avr_timer_comp_t& comp) const {
  const std::uint32_t high = comp.r_ocrh != 0 ? avr_->data[comp.r_ocrh] : 0U;
  return avr_->data[comp.r_ocr] | high << 8U;
}

std::uint16_t TimerShim::count() const {
  if (internalClock() && timer_->tov_cycles > 1) {
    return static_cast<std::uint16_t>((avr_->cycle - timer_->tov_base) / timer_->cs_div_value);
  }
  const unsigned high = timer_->r_tcnth != 0 ? avr_->data[timer_->r_tcnth] : 0U;
  return static_cast<std::uint16_t>(avr_->data[timer_->r_tcnt] | high << 8U);
}

bool TimerShim::watches(avr_io_addr_t addr) const {
  if (addr == 0) return false;
  const auto in = [addr](const avr_regbit_t& bits) { return bits.reg == addr; };
  const auto vector = [&](const avr_int_vector_t& v) {
    return v.vector != 0 && (in(v.enable) || in(v.raised));
  };
  return std::any_of(std::begin(timer_->cs), std::end(timer_->cs), in) ||
         std::any_of(std::begin(timer_->wgm), std::end(timer_->wgm), in) || addr == timer_->r_tcnt ||
         addr == timer_->r_icr || vector(timer_->overflow) || vector(timer_->icr) ||
         std::any_of(std::begin(timer_->comp), std::end(timer_->comp), [&](const avr_timer_comp_t& comp) {
           return addr == comp.r_ocr || in(comp.com) || vector(comp.interrupt);
         });
}

void TimerShim::beforeWrite(avr_io_addr_t /*addr*/) {
  select_before_ = clockSelect();
  mode_before_ = mode();
  count_before_ = count();
}

void TimerShim::afterWrite(avr_io_addr_t addr) {
  const bool restarted = clockSelect() != select_before_ || mode() != mode_before_;
  if (restarted && running()) {
    setCount(count_before_);
  } else if (restarted) {
    avr_->data[timer_->r_tcnt] = static_cast<std::uint8_t>(count_before_);
    if (timer_->r_tcnth != 0) avr_->data[timer_->r_tcnth] = static_cast<std::uint8_t>(count_before_ >> 8U);
  } else if (addr == timer_->r_tcnt && internalClock()) {
    const unsigned high = timer_->r_tcnth != 0 ? avr_->data[timer_->r_tcnth] : 0U;
    makeCountExact(static_cast<std::uint16_t>(avr_->data[timer_->r_tcnt] | high << 8U));
  } else if (addr == timer_->r_icr && timer_->mode.top == avr_timer_wgm_reg_icr && internalClock()) {
    const auto control = controlRegister();
    const std::uint8_t value = avr_->data[control];
    write_control_(avr_, control, static_cast<std::uint8_t>(value & ~7U), write_control_param_);
    write_control_(avr_, control, value, write_control_param_);
    setCount(count_before_);
  }
  raiseEnabled();
  if (zeroTop()) {
    raiseZeroTop();
    avr_cycle_timer_register(avr_, std::max(timer_->cs_div_value, 4U), onZeroTop, this);
  }
  followPwm();
}

void TimerShim::setCount(std::uint16_t value) {
  if (timer_->r_tcnth != 0) avr_->data[timer_->r_tcnth] = static_cast<std::uint8_t>(value >> 8U);
  write_count_(avr_, timer_->r_tcnt, static_cast<std::uint8_t>(value), write_count_param_);
  makeCountExact(value);
}

// simavr takes count * period / TOP cycles as gone by, which should be count * prescaler: move the timers it
// has set.
void TimerShim::makeCountExact(std::uint16_t value) {
  if (timer_->tov_cycles <= 1 || value >= timer_->tov_top || !internalClock()) return;
  const std::uint64_t base = avr_->cycle - std::uint64_t{value} * timer_->cs_div_value;
  const std::uint64_t shift = base - timer_->tov_base;  // modulo 2^64, and so right in both directions
  if (shift == 0) return;
  timer_->tov_base = base;
  std::vector<avr_cycle_timer_slot_t> own;
  for (const auto* slot = avr_->cycle_timers.timer; slot != nullptr; slot = slot->next) {
    if (slot->param == timer_) own.push_back(*slot);
  }
  for (const auto& slot : own) {
    avr_cycle_timer_register(avr_, slot.when + shift - avr_->cycle, slot.timer, slot.param);
  }
}

void TimerShim::raiseEnabled() {
  const auto raise = [this](avr_int_vector_t& v) {
    if (v.vector != 0 && v.pending == 0 && avr_regbit_get(avr_, v.enable) != 0 &&
        avr_regbit_get(avr_, v.raised) != 0) {
      avr_raise_interrupt(avr_, &v);
    }
  };
  raise(timer_->overflow);
  raise(timer_->icr);
  for (auto& comp : timer_->comp) raise(comp.interrupt);
}

bool TimerShim::zeroTop() const {
  return internalClock() && timer_->wgm_op_mode_kind == avr_timer_wgm_ctc &&
         timer_->mode.top != avr_timer_wgm_reg_icr && compareValue(timer_->comp[0]) == 0;
}

void TimerShim::raiseZeroTop() {
  for (auto& comp : timer_->comp) {
    if (comp.r_ocr != 0 && compareValue(comp) == 0) avr_raise_interrupt(avr_, &comp.interrupt);
  }
}

avr_cycle_count_t TimerShim::onZeroTop(avr_t* avr, avr_cycle_count_t when, void* param) {
  auto& self = *static_cast<TimerShim*>(param);
  if (!self.zeroTop()) return 0;
  self.raiseZeroTop();
  // With its interrupt off the flag just stays set; the next write to the timer's registers looks again.
  if (avr_regbit_get(avr, self.timer_->comp[0].interrupt.enable) == 0) return 0;
  return when + std::max(self.timer_->cs_div_value, 4U);
}

// A compare match, or in phase-correct PWM the level that simavr works out.
void TimerShim::onCompare(avr_irq_t* /*irq*/, std::uint32_t value, void* param) {
  auto& output = *static_cast<Output*>(param);
  auto& self = *output.owner;
  if (output.port < 0 || self.fastPwm()) return;
  switch (avr_regbit_get(self.avr_, output.comp->com)) {
    case avr_timer_com_normal:
      break;
    case avr_timer_com_toggle:
      output.level = !output.level;
      break;
    default:
      output.level = (value & 1U) != 0;
      break;
  }
  self.show(output);
}

void TimerShim::show(Output& output) {
  const unsigned com = avr_regbit_get(avr_, output.comp->com);
  const bool connected = com != avr_timer_com_normal && !(fastPwm() && com == kConnectedToggle);
  pins_.setCompareOutput(output.port, output.comp->com_pin.bit, connected, output.level);
}

void TimerShim::followPwm() {
  bool wanted = false;
  for (auto& output : outputs_) {
    if (output.port < 0) continue;
    show(output);
    wanted = wanted || avr_regbit_get(avr_, output.comp->com) > kConnectedToggle;
  }
  wanted = wanted && fastPwm();
  if (wanted) {
    const std::uint64_t bottom = timer_->tov_base + timer_->tov_cycles;
    const auto set = avr_cycle_timer_status(avr_, onBottom, this);
    if (set == 0 || avr_->cycle + set - 1 != bottom) {
      avr_cycle_timer_register(avr_, bottom - avr_->cycle, onBottom, this);
    }
  } else if (pwm_running_) {
    avr_cycle_timer_cancel(avr_, onBottom, this);
    for (auto& output : outputs_) avr_cycle_timer_cancel(avr_, onMatch, &output);
  }
  pwm_running_ = wanted;
}

// BOTTOM of a fast PWM period: take over the compare registers.
avr_cycle_count_t TimerShim::onBottom(avr_t* avr, avr_cycle_count_t when, void* param) {
  auto& self = *static_cast<TimerShim*>(param);
  if (!self.fastPwm()) return 0;
  for (auto& output : self.outputs_) {
    const unsigned com = avr_regbit_get(avr, output.comp->com);
    if (output.port < 0 || com <= kConnectedToggle) continue;
    const std::uint32_t compare = self.compareValue(*output.comp);
    output.level = com == kNonInverting;
    self.show(output);
    if (compare < self.timer_->tov_top) {
      avr_cycle_timer_register(avr, std::uint64_t{compare + 1} * self.timer_->cs_div_value, onMatch, &output);
    }
  }
  return when + self.timer_->tov_cycles;
}

avr_cycle_count_t TimerShim::onMatch(avr_t* avr, avr_cycle_count_t /*when*/, void* param) {
  auto& output = *static_cast<Output*>(param);
  output.level = avr_regbit_get(avr, output.comp->com) != kNonInverting;
  output.owner->show(output);
  return 0;
}

}  // namespace kerfbench::avr_child
