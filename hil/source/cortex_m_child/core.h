// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "hil/source/cortex_m_child/core_bus.h"
#include "hil/source/cortex_m_child/processor.h"

namespace kerfbench::cortex_m_child {

/// A Cortex-M3 without its exceptions, that counts cycles instruction by instruction.
///
/// Each instruction is decoded once, into an operation with its cycles. The table's cycles count
/// (instruction_timing.h); after a branch 1 to refill the pipeline where the instruction says the target and
/// 2 where a register does, and 1 more for a wide target that is not aligned (ARM 2010: 1 to 3); and the
/// flash: lines of 64 bits in two buffers, of which the second is fetched while the first is being used
/// (STMicroelectronics 2015 RM0008, Flash access control register). An instruction that IT skips takes a
/// cycle. A store takes effect at the end of its instruction.
///
/// A loop that neither stores nor reaches a device, and leaves all registers as they were, waits for an
/// interrupt: its iterations up to the limit are passed over, and take their time.
class Core {
 public:
  Core(Present& present, CoreBus& bus, std::span<std::uint8_t> flash, std::span<std::uint8_t> sram,
       std::span<std::uint8_t> system_memory)
      : p_(present, bus, flash, sram, system_memory) {}

  /// Runs until an instruction would begin at the limit or later, except between an IT and the instructions
  /// that depend on it.
  Stop run();
  void setLimit(Cycle limit) { p_.limit = limit; }
  void setFlashTiming(unsigned wait_states, bool prefetches);
  /// Whether accesses that are not aligned, and divisions by zero, are faults.
  void setTraps(bool of_unaligned, bool of_division);
  /// Memory has changed behind the core's back: forget what was decoded.
  void forgetCode(std::uint32_t address, std::uint32_t bytes) { p_.forgetCode(address, bytes); }

  [[nodiscard]] std::uint32_t pc() const { return p_.pc; }
  /// Goes on there; the pipeline is refilled at no cost, because an exception's cycles contain it.
  void jump(std::uint32_t address);
  /// Goes on behind an instruction of this size that was carried out elsewhere.
  void continueBehind(std::uint32_t bytes);
  /// Where an access, or a jump, has led.
  [[nodiscard]] std::uint32_t faultAddress() const { return p_.fault_address; }
  /// Half-word at an address of flash or SRAM; nothing elsewhere.
  [[nodiscard]] std::optional<std::uint16_t> halfWord(std::uint32_t address) const {
    return p_.halfWord(address);
  }

  [[nodiscard]] std::uint32_t get(unsigned register_number) const { return p_.r[register_number]; }
  void set(unsigned register_number, std::uint32_t value);
  /// N, Z, C, V and Q in bits 31 to 27.
  [[nodiscard]] std::uint32_t flags() const;
  void setFlags(std::uint32_t value);
  /// ITSTATE in bits 26, 25 and 15 to 10, as the xPSR that an exception stacks has it.
  [[nodiscard]] std::uint32_t ifThen() const;
  void setIfThen(std::uint32_t value);
  /// R0 to R3, R12, LR, as an exception stacks them.
  [[nodiscard]] std::array<std::uint32_t, 6> scratch() const;
  void setScratch(const std::array<std::uint32_t, 6>& values);

 private:
  Processor p_;
};

}  // namespace kerfbench::cortex_m_child
