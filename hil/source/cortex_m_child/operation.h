// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "hil/source/cortex_m_child/memory_map.h"
#include "hil/source/emulator/tail_call.h"

namespace kerfbench::cortex_m_child {

/// Why the core stops.
enum class Stop : std::uint8_t {
  kLimit,          ///< The limit is reached, or was drawn in by an access.
  kTrap,           ///< The instruction at the PC is one of the exception unit's.
  kExceptionExit,  ///< The PC was loaded with an EXC_RETURN.
  kUndefined,      ///< The instruction at the PC does not exist, or is UNPREDICTABLE.
  kNotThumb,       ///< The instruction at the PC leads to an even address.
  kBadFetch,       ///< Nothing that could be executed is where the PC leads.
  kBadAccess,      ///< The instruction at the PC has nothing at the address of its access.
  kUnaligned,      ///< The instruction at the PC accesses words at an address that is not one of a word.
  kDivisionByZero  ///< The instruction at the PC divides by zero, which the firmware wants to know.
};

struct Processor;
struct Operation;

/// Carries an operation out, whose cycles are part of `now` already, and goes on with those that follow.
using Handler = Stop (*)(Processor& p, Operation* at, Cycle now);

/// A decoded instruction. What is in the operands depends on its handler; names are those of ARMv7-M 2010.
struct Operation {
  static constexpr std::uint8_t kUndecoded = 1;
  /// Lies behind an IT: nothing comes between the IT and it.
  static constexpr std::uint8_t kConditional = 2;
  /// The last half-word is in another line of the flash than the half-word before it.
  static constexpr std::uint8_t kCrosses = 4;
  /// Follows a load in the next cycle, unless it needs what that loads for its address.
  static constexpr std::uint8_t kPipelines = 8;

  Handler execute{};
  union {
    std::uint32_t number{};  ///< Immediate value, offset, address, or list of registers.
    Operation* target;       ///< Where a direct branch leads.
  };
  std::uint32_t pc{};
  std::uint8_t d{};      ///< Destination; Rt of loads and stores.
  std::uint8_t n{};      ///< First operand, base.
  std::uint8_t m{};      ///< Second operand, offset.
  std::uint8_t shift{};  ///< Amount of a shift, least bit of a field.
  std::uint8_t kind{};   ///< Whatever else the handler wants to know.
  std::uint8_t step{1};  ///< Operations from this to the next.
  std::uint8_t bytes{2};
  std::uint8_t cycles{};
  std::uint8_t refill{1};  ///< Cycles that a branch to here takes for the pipeline.
  std::uint8_t base{};     ///< The register that gives a load's or store's address; see instruction_timing.h.
  std::uint8_t loads{};    ///< The register that a single load fills.
  std::uint8_t flags{kUndecoded};

  [[nodiscard]] bool has(unsigned flag) const { return (flags & flag) != 0; }
  /// The line of the flash, of 8 bytes, that has the instruction's last half-word.
  [[nodiscard]] std::uint32_t line() const { return (pc + bytes - 2) / 8; }
};
static_assert(sizeof(Operation) == 32);

}  // namespace kerfbench::cortex_m_child
