// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace kerfbench::cortex_m_child {

/// Registers R0 to LR, the flags N, Z, C, V and Q in bits 31 to 27, and the SRAM.
struct MachineState {
  std::array<std::uint32_t, 15> r{};
  std::uint32_t flags{};
  std::vector<std::uint8_t> sram;
  std::uint64_t cycles{};  ///< What the run took; ours only.
};

inline constexpr std::uint32_t kCodeBase = 0x08000000, kCodeBytes = 0x40000;
inline constexpr std::uint32_t kDataBase = 0x20000000, kDataBytes = 0x5000;

/// A core that runs programs of one image, each from a state of its own.
class TestedCore {
 public:
  virtual ~TestedCore() = default;
  /// From `begin` to before the instruction at `end`. Says in words what went wrong, or nothing.
  virtual std::string run(std::uint32_t begin, std::uint32_t end, MachineState& state) = 0;
};

/// @param slice where it is not 0, the core stops and goes on after so many cycles again and again.
std::unique_ptr<TestedCore> makeOurs(std::vector<std::uint8_t>& code, std::uint64_t slice = 0);
std::unique_ptr<TestedCore> makeUnicorn(std::vector<std::uint8_t>& code);

}  // namespace kerfbench::cortex_m_child
