// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <string_view>

namespace kerfbench::determinism {

/// Hash FNV-1a, 64 bits, over the bits of all that is added.
class Fnv {
 public:
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) addByte(static_cast<std::uint8_t>(value >> (8 * byte)));
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(float value) { add(std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
  void add(std::string_view text) {
    for (const char c : text) addByte(static_cast<std::uint8_t>(c));
    addByte(0);
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  void addByte(std::uint8_t byte) { value_ = (value_ ^ byte) * 0x100000001b3ULL; }
  std::uint64_t value_{0xcbf29ce484222325ULL};
};

}  // namespace kerfbench::determinism
