// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace kerfbench::source {

// Private to this room.

/// Decimal digits at the begin of a text.
struct Digits {
  std::uint64_t value{};  ///< Overflown where there are more than kMost of them.
  std::size_t count{};    ///< At most kRead.

  static constexpr std::size_t kMost = 19;  ///< A number of so many fits 64 bits.
  static constexpr std::size_t kRead = 24;  ///< Bytes that are looked at.
};

/// The digits among eight bytes, of which the first comes lowest: their number, and their value.
inline Digits digitsOfEight(std::uint64_t bytes) {
  constexpr std::uint64_t kEach = 0x0101010101010101;
  const std::uint64_t values = bytes ^ '0' * kEach;  // 0 … 9 for a digit.
  const std::uint64_t others = (((values & 0x7F * kEach) + 0x76 * kEach) | values) & 0x80 * kEach;
  const auto count = static_cast<std::size_t>(std::countr_zero(others)) / 8;
  if (count == 0) return {};
  // As if zeros stood before them.
  const std::uint64_t digits = values << 8 * (8 - count);
  // Numbers of two digits in every other byte, then of four and of eight by one multiplication each.
  const std::uint64_t pairs = digits * 10 + (digits >> 8U);
  constexpr std::uint64_t kPair = 0x000000FF000000FF;
  constexpr std::uint64_t kFirstAndThird = 100 + (std::uint64_t{1'000'000} << 32U);
  constexpr std::uint64_t kSecondAndFourth = 1 + (std::uint64_t{10'000} << 32U);
  return {((pairs & kPair) * kFirstAndThird + (pairs >> 16U & kPair) * kSecondAndFourth) >> 32U, count};
}

/// The digits at `at`, from where Digits::kRead bytes can be read.
inline Digits digitsAt(const char* at) {
  constexpr std::array<std::uint64_t, 9> kPowers{1,       10,        100,        1'000,      10'000,
                                                 100'000, 1'000'000, 10'000'000, 100'000'000};
  Digits all;
  while (all.count < Digits::kRead) {
    std::uint64_t bytes = 0;
    std::memcpy(&bytes, at + all.count, sizeof bytes);
    if constexpr (std::endian::native == std::endian::big) bytes = __builtin_bswap64(bytes);
    const Digits more = digitsOfEight(bytes);
    all.value = all.value * kPowers.at(more.count) + more.value;
    all.count += more.count;
    if (more.count < sizeof bytes) break;
  }
  return all;
}

}  // namespace kerfbench::source
