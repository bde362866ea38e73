// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "hil/source/cortex_m_child/core.h"
#include "hil/source/cortex_m_child/nvic.h"
#include "hil/source/cortex_m_child/system_control.h"

namespace kerfbench::cortex_m_child {

/// Lets devices catch up while the core stacks registers.
class DeviceTime {
 public:
  virtual ~DeviceTime() = default;
  virtual void runDevicesTo(Cycle cycle) = 0;
};

/// Exceptions of ARMv7-M: entry and return, the two stacks, faults, and the instructions that touch them.
///
/// Entry takes 12 cycles, a return 12 with its branch, and from one handler to the next without unstacking
/// (tail-chaining) 6 with the branch. What arrives in the first 8 cycles of an entry and has a higher
/// priority is entered instead (late arrival). All as ARM 2010, Exception handling, has it for memories
/// without wait states: those of the vector's fetch pass behind the stacking.
class ExceptionUnit {
 public:
  ExceptionUnit(Present& present, Core& core, Nvic& nvic, SystemControl& control, DeviceTime& devices,
                std::span<std::uint8_t> sram);

  /// Stack pointer and PC from the vector table at the flash's start.
  void reset();
  /// Enters the pending exception that pre-empts, if one does; the core stands between two instructions.
  bool enterNext();
  void returnFrom(std::uint32_t exception_return);
  /// The instruction at the core's PC is one of those with Timing::kTrap.
  void executeTrap();
  /// The instruction at the core's PC has failed: `what` says how. Enters the firmware's handler if it has
  /// one that does anything, and ends the run in words otherwise. `address` is that of a bad access.
  void fault(unsigned exception, std::uint32_t status, const std::string& what, std::uint32_t address = 0);

  [[nodiscard]] bool isAsleep() const { return asleep_; }
  /// Whether the core sleeps by WFE, which an event ends as well.
  [[nodiscard]] bool awaitsEvent() const { return awaits_event_; }
  void wake() { asleep_ = awaits_event_ = false; }
  void signalEvent() { event_ = true; }
  [[nodiscard]] bool takeEvent();
  [[nodiscard]] unsigned currentException() const { return ipsr_; }

 private:
  void enter(std::uint32_t return_address);
  void begin(unsigned exception);
  bool push(std::uint32_t return_address);
  bool pop(std::uint32_t exception_return);
  bool word(std::uint32_t address, std::uint32_t& value) const;
  bool handles(unsigned exception) const;
  void crash(const std::string& what);
  void goOnBehind(std::uint32_t bytes);
  void hint(unsigned operation);
  void changeState(std::uint32_t code);
  std::uint32_t readSpecial(unsigned number) const;
  void writeSpecial(unsigned number, unsigned mask, std::uint32_t value);
  void setControl(std::uint32_t value);

  Present& present_;
  Core& core_;
  Nvic& nvic_;
  SystemControl& control_;
  DeviceTime& devices_;
  std::span<std::uint8_t> sram_;
  unsigned ipsr_{};
  std::uint32_t control_register_{};  ///< CONTROL: bit 0 nPRIV, bit 1 SPSEL.
  std::uint32_t other_stack_{};       ///< The stack pointer that is not in R13.
  bool on_process_stack_{};
  bool asleep_{};
  bool awaits_event_{};
  bool event_{};
  std::string last_fault_;
};

}  // namespace kerfbench::cortex_m_child
