// SPDX-License-Identifier: Apache-2.0
#include "hil/source/cortex_m_child/exceptions.h"

#include <cstring>
#include <utility>

namespace kerfbench::cortex_m_child {
namespace {

constexpr Cycle kEntryCycles = 12, kLateArrivalCycles = 8;
constexpr Cycle kTailChainCycles = 5, kReturnCycles = 11;  // A cycle more is the branch's own.
constexpr unsigned kStackPointer = 13, kLink = 14;
constexpr std::uint32_t kFrameBytes = 32, kThumb = 1U << 24, kAligned = 1U << 9;
constexpr std::uint32_t kToHandler = 0xFFFFFFF1, kToThread = 0xFFFFFFF9, kToProcess = 0xFFFFFFFD;
constexpr std::uint32_t kExceptionMask = 0x1FF;
constexpr std::uint32_t kForced = 1U << 30;  // HFSR

}  // namespace

ExceptionUnit::ExceptionUnit(Present& present, Core& core, Nvic& nvic, SystemControl& control,
                             DeviceTime& devices, std::span<std::uint8_t> sram)
    : present_(present), core_(core), nvic_(nvic), control_(control), devices_(devices), sram_(sram) {}

void ExceptionUnit::reset() {
  ipsr_ = 0;
  control_register_ = other_stack_ = 0;
  on_process_stack_ = asleep_ = awaits_event_ = event_ = false;
  std::uint32_t stack = 0;
  std::uint32_t start = 0;
  (void)word(kFlashBase, stack);
  (void)word(kFlashBase + 4, start);
  for (unsigned i = 0; i < kStackPointer; ++i) core_.set(i, 0);
  core_.set(kStackPointer, stack & ~3U);
  core_.set(kLink, 0xFFFFFFFF);
  core_.setFlags(0);
  core_.jump(start);
}

bool ExceptionUnit::takeEvent() { return std::exchange(event_, false); }

bool ExceptionUnit::word(std::uint32_t address, std::uint32_t& value) const {
  const auto low = core_.halfWord(address);
  const auto high = core_.halfWord(address + 2);
  if (!low || !high) return false;
  value = *low | std::uint32_t{*high} << 16;
  return true;
}

void ExceptionUnit::crash(const std::string& what) {
  if (!present_.failure.empty()) return;
  present_.failure = "the firmware crashed at " + hex32(core_.pc()) + ": " + what;
  if (!last_fault_.empty() && last_fault_ != what)
    present_.failure += "; it had faulted before: " + last_fault_;
}

bool ExceptionUnit::enterNext() {
  if (!nvic_.next()) return false;
  asleep_ = awaits_event_ = false;
  enter(core_.pc());
  return true;
}

void ExceptionUnit::enter(std::uint32_t return_address) {
  if (!push(return_address)) return;
  const Cycle start = present_.cycle;
  devices_.runDevicesTo(start + kLateArrivalCycles);
  present_.cycle = start + kEntryCycles;
  const std::uint32_t back = ipsr_ != 0 ? kToHandler : on_process_stack_ ? kToProcess : kToThread;
  if (on_process_stack_) {
    const std::uint32_t process_stack = core_.get(kStackPointer);
    core_.set(kStackPointer, std::exchange(other_stack_, process_stack));
    on_process_stack_ = false;
  }
  core_.set(kLink, back);
  // What was to be entered is still pending, or something of a higher priority.
  begin(nvic_.next().value_or(kHardFault));
}

void ExceptionUnit::begin(unsigned exception) {
  std::uint32_t vector = 0;
  if (!word(control_.vectorTable() + 4 * exception, vector))
    return crash("the vector table at " + hex32(control_.vectorTable()) + " is in no memory");
  nvic_.activate(exception);
  ipsr_ = exception;
  core_.jump(vector);
  if ((vector & 1U) == 0)
    fault(kUsageFault, 1U << 17,
          "the vector of exception " + std::to_string(exception) + ", " + hex32(vector) +
              ", lacks the bit of Thumb");
}

bool ExceptionUnit::push(std::uint32_t return_address) {
  const std::uint32_t stack = core_.get(kStackPointer);
  const bool is_padded = control_.alignsStack() && (stack & 4U) != 0;
  const std::uint32_t frame = stack - kFrameBytes - (is_padded ? 4U : 0U);
  if (frame < kSramBase || frame - kSramBase > sram_.size() - kFrameBytes) {
    crash("an exception's frame at " + hex32(frame) + " is outside the SRAM: the stack has overflowed");
    return false;
  }
  std::uint32_t words[8];
  const auto scratch = core_.scratch();
  std::memcpy(words, scratch.data(), sizeof scratch);
  words[6] = return_address;
  words[7] = core_.flags() | core_.ifThen() | kThumb | (is_padded ? kAligned : 0U) | ipsr_;
  std::memcpy(sram_.data() + (frame - kSramBase), words, sizeof words);
  core_.set(kStackPointer, frame);
  return true;
}

void ExceptionUnit::returnFrom(std::uint32_t exception_return) {
  const bool is_known =
      exception_return == kToHandler || exception_return == kToThread || exception_return == kToProcess;
  if (!is_known || ipsr_ == 0)
    return fault(kUsageFault, 1U << 18, "a return from an exception with " + hex32(exception_return));
  nvic_.deactivate(ipsr_);
  if (ipsr_ != 2) nvic_.faultmask = false;
  present_.cycle += kTailChainCycles;
  devices_.runDevicesTo(present_.cycle);
  if (const auto next = nvic_.next()) {
    core_.set(kLink, exception_return);
    return begin(*next);
  }
  if (!pop(exception_return)) return;
  present_.cycle += kReturnCycles - kTailChainCycles;
  if (ipsr_ == 0 && control_.sleepsOnExit()) asleep_ = true;
}

bool ExceptionUnit::pop(std::uint32_t exception_return) {
  if (exception_return == kToProcess) {
    const std::uint32_t main_stack = core_.get(kStackPointer);
    core_.set(kStackPointer, std::exchange(other_stack_, main_stack));
    on_process_stack_ = true;
  }
  const std::uint32_t frame = core_.get(kStackPointer);
  if (frame < kSramBase || frame - kSramBase > sram_.size() - kFrameBytes) {
    crash("the frame of a return from an exception, at " + hex32(frame) + ", is outside the SRAM");
    return false;
  }
  std::uint32_t words[8];
  std::memcpy(words, sram_.data() + (frame - kSramBase), sizeof words);
  core_.setScratch({words[0], words[1], words[2], words[3], words[4], words[5]});
  core_.set(kStackPointer, frame + kFrameBytes + ((words[7] & kAligned) != 0 ? 4U : 0U));
  core_.setFlags(words[7]);
  ipsr_ = words[7] & kExceptionMask;
  control_register_ = (control_register_ & 1U) | (on_process_stack_ ? 2U : 0U);
  core_.jump(words[6]);
  core_.setIfThen(words[7]);
  if ((exception_return == kToHandler) != (ipsr_ != 0)) {
    crash("a return from an exception finds a damaged frame at " + hex32(frame));
    return false;
  }
  return true;
}

/// Whether the handler does more than branch to itself, which is what firmware has for exceptions that it
/// does not expect.
bool ExceptionUnit::handles(unsigned exception) const {
  constexpr std::uint16_t kBranchToItself = 0xE7FE, kBreakpoint = 0xBE00;
  std::uint32_t vector = 0;
  if (!word(control_.vectorTable() + 4 * exception, vector) || (vector & 1U) == 0) return false;
  const auto first = core_.halfWord(vector & ~1U);
  return first && *first != kBranchToItself && (*first & 0xFF00U) != kBreakpoint && *first != 0xFFFF;
}

void ExceptionUnit::fault(unsigned exception, std::uint32_t status, const std::string& what,
                          std::uint32_t address) {
  control_.recordFault(status, address);
  const bool is_own = nvic_.isEnabled(exception) && nvic_.canPreempt(exception);
  const unsigned taken = is_own ? exception : kHardFault;
  if (nvic_.isLockedUpByFault()) return crash(what + ", in the handler of a fault: the core locks up");
  if (!handles(taken)) return crash(what);
  if (taken == kHardFault) control_.recordHardFault(kForced);
  last_fault_ = what + " at " + hex32(core_.pc());
  nvic_.pend(taken);
  enter(core_.pc());
}

void ExceptionUnit::goOnBehind(std::uint32_t bytes) {
  present_.cycle += 1;
  core_.continueBehind(bytes);
}

void ExceptionUnit::executeTrap() {
  const std::uint32_t pc = core_.pc();
  const std::uint32_t first = core_.halfWord(pc).value_or(0);
  const std::uint32_t second = core_.halfWord(pc + 2).value_or(0);
  if ((first & 0xFF00U) == 0xDF00U) {
    if (!nvic_.canPreempt(kSvCall)) return fault(kHardFault, 0, "SVC where its priority does not allow it");
    goOnBehind(2);
    nvic_.pend(kSvCall);
    enter(pc + 2);
  } else if ((first & 0xFF00U) == 0xBE00U) {
    fault(kHardFault, 0, "a breakpoint (BKPT) without a debugger");
  } else if ((first & 0xFF00U) == 0xBF00U) {
    goOnBehind(2);
    hint(first >> 4 & 0xFU);
  } else if ((first & 0xFF00U) == 0xB600U) {
    present_.cycle += 1;
    goOnBehind(2);
    changeState(first);
  } else if (first == 0xF3AFU) {
    goOnBehind(4);
    hint(second & 0xFU);
  } else if ((first & 0xFFE0U) == 0xF3E0U) {
    present_.cycle += 1;
    core_.set(second >> 8 & 0xFU, readSpecial(second & 0xFFU));
    goOnBehind(4);
  } else {
    present_.cycle += 1;
    const std::uint32_t value = core_.get(first & 0xFU);
    goOnBehind(4);
    writeSpecial(second & 0xFFU, second >> 10 & 3U, value);
  }
}

void ExceptionUnit::hint(unsigned operation) {
  constexpr unsigned kWaitForEvent = 2, kWaitForInterrupt = 3, kSendEvent = 4;
  if (operation == kSendEvent) event_ = true;
  if (operation == kWaitForInterrupt) asleep_ = true;
  if (operation == kWaitForEvent && !takeEvent()) asleep_ = awaits_event_ = true;
}

void ExceptionUnit::changeState(std::uint32_t code) {
  const bool disables = (code & 0x10U) != 0;
  if ((code & 2U) != 0) nvic_.primask = disables;
  if ((code & 1U) != 0) nvic_.faultmask = disables;
}

std::uint32_t ExceptionUnit::readSpecial(unsigned number) const {
  const std::uint32_t stack = core_.get(kStackPointer);
  switch (number) {
    case 0:
    case 2:
      return core_.flags();
    case 1:
    case 3:
      return core_.flags() | ipsr_;
    case 5:
    case 7:
      return ipsr_;
    case 8:
      return on_process_stack_ ? other_stack_ : stack;
    case 9:
      return on_process_stack_ ? stack : other_stack_;
    case 16:
      return nvic_.primask ? 1 : 0;
    case 17:
    case 18:
      return nvic_.basepri;
    case 19:
      return nvic_.faultmask ? 1 : 0;
    case 20:
      return control_register_;
    default:
      return 0;
  }
}

void ExceptionUnit::writeSpecial(unsigned number, unsigned mask, std::uint32_t value) {
  const auto base = static_cast<std::uint8_t>(value & 0xF0U);
  switch (number) {
    case 8:
    case 9:
      if ((number == 9) == on_process_stack_) {
        core_.set(kStackPointer, value & ~3U);
      } else {
        other_stack_ = value & ~3U;
      }
      break;
    case 16:
      nvic_.primask = (value & 1U) != 0;
      break;
    case 17:
      nvic_.basepri = base;
      break;
    case 18:
      if (base != 0 && (nvic_.basepri == 0 || base < nvic_.basepri)) nvic_.basepri = base;
      break;
    case 19:
      nvic_.faultmask = (value & 1U) != 0 && !nvic_.isLockedUpByFault();
      break;
    case 20:
      setControl(value);
      break;
    default:
      if (number <= 3 && (mask & 2U) != 0) core_.setFlags(value);
      break;
  }
}

void ExceptionUnit::setControl(std::uint32_t value) {
  const bool wants_process = ipsr_ == 0 ? (value & 2U) != 0 : on_process_stack_;
  control_register_ = (value & 1U) | (wants_process ? 2U : 0U);
  if (wants_process == on_process_stack_) return;
  on_process_stack_ = wants_process;
  const std::uint32_t stack = core_.get(kStackPointer);
  core_.set(kStackPointer, std::exchange(other_stack_, stack));
}

}  // namespace kerfbench::cortex_m_child
