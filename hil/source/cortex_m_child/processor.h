// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hil/source/cortex_m_child/core_bus.h"
#include "hil/source/cortex_m_child/instruction_timing.h"
#include "hil/source/cortex_m_child/operation.h"

namespace kerfbench::cortex_m_child {

inline constexpr unsigned kSp = 13, kLr = 14, kPc = 15;
/// From here on an address in the PC is an EXC_RETURN.
inline constexpr std::uint32_t kExceptionReturns = 0xF0000000;

/// Memory that code can be in, with an operation for each half-word.
struct CodeRegion {
  CodeRegion(std::uint32_t first_address, std::span<std::uint8_t> memory, Handler undecoded);
  [[nodiscard]] Operation* at(std::uint32_t address) {
    const std::uint32_t offset = address - base;
    return offset < bytes.size() ? &operations[offset / 2] : nullptr;
  }
  std::uint32_t base;
  std::span<std::uint8_t> bytes;
  std::vector<Operation> operations;  ///< One more than half-words: the end of the memory.
};

/// The last branch backwards, how many iterations have changed nothing but registers, and what these were.
struct Loop {
  std::uint32_t head{};
  unsigned pure_iterations{};
  unsigned next_look{};
  Cycle began{};
  Cycle period{};
  std::array<std::uint32_t, 16> state{};
};

/// What instructions work on: registers, flags, memories, and the time of the fetches.
struct Processor {
  std::array<std::uint32_t, 16> r{};  ///< R0 to LR. The PC is the operation's.
  std::uint32_t negative{};           ///< N is its bit 31.
  std::uint32_t zero{1};              ///< Z is set where this is 0.
  std::uint32_t carry{};              ///< C, 0 or 1.
  std::uint32_t overflow{};           ///< V is its bit 31.
  Cycle limit{};
  std::uint8_t* sram{};
  std::uint32_t sram_bytes{};
  std::uint32_t sram_code{};  ///< Offset and size of the SRAM from which operations were decoded.
  std::uint32_t sram_code_bytes{};
  Cycle next_line_at{};  ///< When the prefetch buffer has the line after the present one.
  unsigned wait_states{};
  bool prefetches{true};
  bool has_effect{};  ///< Since the last branch backwards something but registers was changed or asked.
  bool saturated{};   ///< Q
  bool exclusive{};   ///< The local monitor of LDREX.
  bool traps_unaligned{};
  bool traps_division{};
  std::uint8_t last_load{Timing::kNoRegister};  ///< Kept where the next operation is not seen at once.
  std::uint8_t if_then{};                       ///< ITSTATE where the core stands behind an IT.
  std::uint32_t owed_lines{};                   ///< Lines that began in instructions that IT has skipped.
  std::uint32_t pc{};
  std::uint32_t line{};  ///< Line of the flash that was fetched last, where the core stands.
  std::uint32_t fault_address{};
  Loop loop;
  CodeRegion flash_region, sram_region, alias_region;
  std::span<std::uint8_t> system_memory;
  Present& present;
  CoreBus& bus;
  Stop failure{};  ///< Why an access has failed.
  /// Instructions behind an IT are decoded once for each IT, into blocks that are given out in turn.
  static constexpr std::size_t kBlock = 9, kBlocks = 4096;
  std::vector<Operation> blocks;
  std::size_t next_block{1};  ///< The first is for a return to between an IT and what depends on it.

  Processor(Present& the_present, CoreBus& the_bus, std::span<std::uint8_t> flash,
            std::span<std::uint8_t> the_sram, std::span<std::uint8_t> the_system_memory);

  [[nodiscard]] CodeRegion* regionAt(std::uint32_t address);
  [[nodiscard]] Operation* operationAt(std::uint32_t address);
  [[nodiscard]] std::optional<std::uint16_t> halfWord(std::uint32_t address) const;
  void forgetCode(std::uint32_t address, std::uint32_t count);
  void forgetAll();

  void setNegativeZero(std::uint32_t result) { negative = zero = result; }
  /// Reads where the inline path for the SRAM does not; nothing after a failure. Present::cycle is that of
  /// the access before, and with what it has waited after.
  std::optional<std::uint32_t> readElsewhere(const Operation* at, std::uint32_t address, unsigned bytes);
  bool writeElsewhere(const Operation* at, std::uint32_t address, unsigned bytes, std::uint32_t value);
  std::optional<std::uint32_t> readWord(const Operation* at, std::uint32_t address);
  bool writeWord(const Operation* at, std::uint32_t address, std::uint32_t value);

  [[nodiscard]] Cycle afterFetch(Cycle now, bool is_next_line);
  [[nodiscard]] bool looksIdle(Cycle now);
  [[nodiscard]] Cycle afterIdleLoop(Cycle now);
  /// The core stands at an operation for a reason other than the limit.
  Stop stopAt(const Operation* at, Cycle now, Stop why);

 private:
  void forgetIn(CodeRegion& region, std::uint32_t offset, std::uint32_t count);
  [[nodiscard]] bool isDevice(std::uint32_t address) const;
  std::optional<std::uint32_t> fail(std::uint32_t address, Stop why);
};

}  // namespace kerfbench::cortex_m_child
