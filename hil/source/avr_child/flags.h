// SPDX-License-Identifier: GPL-3.0-or-later
// Results of eight bits with their flags. In a ^ b ^ (a + b) each bit is what was carried into it; so it is
// for a - b and what was borrowed: C is bit 8, H bit 4, and V is where what goes into bit 7 and out of it
// differ. Equations of the flags are those of the manual's pages of ADD, ADC, SUB, SBC and AND (Atmel 2016).
#pragma once

#include "hil/source/avr_child/processor.h"

namespace kerfbench::avr_child {

inline constexpr std::uint32_t kCarryFlag = 1U << 8U, kHalfCarryFlag = 1U << 4U, kOverflowFlag = 1U << 8U;

inline void setCarry(Processor& p, std::uint32_t is_carry) {
  p.carries = (p.carries & kHalfCarryFlag) | is_carry << 8U;
}

/// N, V and S of a result; Z is the caller's.
inline void setSigns(Processor& p, std::uint32_t result, std::uint32_t overflow) {
  p.negative = result;
  p.overflow = overflow;
}

/// All flags of a sum or difference.
inline void setCarries(Processor& p, std::uint32_t a, std::uint32_t b, std::uint32_t result) {
  const std::uint32_t carries = a ^ b ^ result;
  p.carries = carries;
  setSigns(p, result, carries ^ carries << 1U);
}

inline std::uint8_t sum(Processor& p, std::uint32_t a, std::uint32_t b, std::uint32_t carry = 0) {
  const std::uint32_t result = a + b + carry;
  setCarries(p, a, b, result);
  p.zero = result & 0xFFU;
  return static_cast<std::uint8_t>(result);
}

inline std::uint8_t difference(Processor& p, std::uint32_t a, std::uint32_t b) {
  const std::uint32_t result = a - b;
  setCarries(p, a, b, result);
  p.zero = result & 0xFFU;
  return static_cast<std::uint8_t>(result);
}

/// The next byte of a longer number: Z stays clear where the lower bytes were not zero.
inline std::uint8_t differenceAbove(Processor& p, std::uint32_t a, std::uint32_t b) {
  const std::uint32_t result = a - b - p.carry();
  setCarries(p, a, b, result);
  p.zero |= result & 0xFFU;
  return static_cast<std::uint8_t>(result);
}

/// Flags of AND, OR, EOR and of all that leave C and H: V is given.
inline std::uint8_t logical(Processor& p, std::uint32_t result, std::uint32_t overflow = 0) {
  setSigns(p, result, overflow);
  p.zero = result;
  return static_cast<std::uint8_t>(result);
}

/// Flags of LSR, ROR and ASR, where the bit 0 of `from` goes to C, and V = N xor C.
inline std::uint8_t shifted(Processor& p, std::uint32_t from, std::uint32_t result) {
  const std::uint32_t out = from & 1U;
  setCarry(p, out);
  return logical(p, result, (result << 1U ^ out << 8U) & kOverflowFlag);
}

}  // namespace kerfbench::avr_child
