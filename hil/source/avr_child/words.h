// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of two bytes in the data space, the lower byte at the lower address. What is written by bytes is
// read by bytes, and what is written as a whole is read as either: a processor that has to put a word
// together from two stores that are still under way waits for both.
#pragma once

#include <sim_avr.h>

#include <bit>
#include <cstdint>
#include <cstring>

namespace kerfbench::avr_child {

static_assert(std::endian::native == std::endian::little);

inline void setWordIn(std::uint8_t* data, std::uint32_t address, std::uint32_t value) {
  const auto word = static_cast<std::uint16_t>(value);
  std::memcpy(data + address, &word, sizeof word);
}

/// A pair of registers, which most instructions write one by one. Relaxed loads are not made one by the
/// compiler.
[[nodiscard]] inline std::uint32_t pairIn(const std::uint8_t* data, std::uint32_t address) {
  const std::uint32_t low = __atomic_load_n(data + address, __ATOMIC_RELAXED);
  const std::uint32_t high = __atomic_load_n(data + address + 1, __ATOMIC_RELAXED);
  return low | high << 8U;
}

/// The stack grows downwards; its pointer is below its last byte. Seldom written but by what reads it.
[[nodiscard]] inline std::uint32_t stackPointer(const std::uint8_t* data) {
  std::uint16_t word = 0;
  std::memcpy(&word, data + R_SPL, sizeof word);
  return word;
}
inline void setStackPointer(std::uint8_t* data, std::uint32_t value) { setWordIn(data, R_SPL, value); }

}  // namespace kerfbench::avr_child
