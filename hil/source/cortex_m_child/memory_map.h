// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace kerfbench::cortex_m_child {

/// Cycles of the core clock (HCLK) since the start.
using Cycle = std::uint64_t;
inline constexpr Cycle kNever = std::numeric_limits<Cycle>::max();

inline constexpr std::uint32_t kFlashBase = 0x08000000;
inline constexpr std::uint32_t kSystemMemoryBase = 0x1FFFF000;  ///< Boot loader, and the part's identity.
inline constexpr std::uint32_t kSystemMemoryBytes = 0x1000;
inline constexpr std::uint32_t kSramBase = 0x20000000;
inline constexpr std::uint32_t kSramAliasBase = 0x22000000;  ///< A word for each bit of the first MiB.
inline constexpr std::uint32_t kDeviceBase = 0x40000000;
inline constexpr std::uint32_t kDeviceBytes = 0x30000;
inline constexpr std::uint32_t kDeviceAliasBase = 0x42000000;
inline constexpr std::uint32_t kSystemBase = 0xE0000000;
inline constexpr std::uint32_t kSystemBytes = 0x100000;

/// An address in eight hexadecimal digits.
std::string hex32(std::uint64_t value);

}  // namespace kerfbench::cortex_m_child
