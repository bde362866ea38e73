// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerfbench::cortex_m_child {

/// What an instruction costs on a Cortex-M3 r2p1, without waiting for memories or for the pipeline after a
/// branch (ARM 2010, table of cycle counts). Where the table gives a range that depends on operands, the
/// middle is taken: 4 of 3 to 5 for UMULL and SMULL, 5 of 4 to 7 for UMLAL and SMLAL, 7 of 2 to 12 for a
/// division.
struct Timing {
  static constexpr std::uint8_t kNoRegister = 0xFF;
  /// Carried out by the exception unit, which adds its cycles: MRS, MSR, CPS, SVC, BKPT, WFI, WFE, SEV.
  static constexpr std::uint8_t kTrap = 1;
  /// Follows a load in the next cycle, unless it needs what that loads for its address.
  static constexpr std::uint8_t kPipelines = 2;

  std::uint8_t cycles{1};
  std::uint8_t loads{kNoRegister};  ///< The register that a single load fills.
  std::uint8_t base{kNoRegister};   ///< The register that gives a load's or store's address.
  std::uint8_t flags{};

  [[nodiscard]] bool has(std::uint8_t flag) const { return (flags & flag) != 0; }
};

/// Whether the first half-word begins an instruction of two.
[[nodiscard]] constexpr bool isWide(std::uint32_t first) { return (first & 0xF800U) >= 0xE800U; }

/// The timing of an instruction; `second` counts only where isWide(first).
[[nodiscard]] Timing timingOf(std::uint16_t first, std::uint16_t second);

}  // namespace kerfbench::cortex_m_child
