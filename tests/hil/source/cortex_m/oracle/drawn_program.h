// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "twin/base/random.h"

namespace kerfbench::cortex_m_child {

/// Classes of encodings from which a program draws.
enum class Drawn : std::uint8_t { kData16, kData32, kMultiply, kField, kSingle, kMultiple, kIfThen, kBranch };
inline constexpr Drawn kAllDrawn[] = {Drawn::kData16, Drawn::kData32,   Drawn::kMultiply, Drawn::kField,
                                      Drawn::kSingle, Drawn::kMultiple, Drawn::kIfThen,   Drawn::kBranch};

/// A program of drawn instructions, none of them UNPREDICTABLE, that goes through to its end whatever the
/// registers are at first. It stores to the SRAM only.
class DrawnProgram {
 public:
  DrawnProgram(std::uint64_t seed, std::uint64_t number) : random_(seed, number) {}
  /// Half-words of `instructions` of the classes, and before some of them what their addresses need.
  std::vector<std::uint16_t> draw(const std::vector<Drawn>& classes, unsigned instructions);

 private:
  std::uint32_t below(std::uint32_t bound);
  bool chance(unsigned of_256) { return below(256) < of_256; }
  std::uint32_t ordinary();
  template <typename T, std::size_t kSize>
  const T& oneOf(const T (&choices)[kSize]) {
    return choices[below(kSize)];
  }
  void put16(std::uint32_t code) { code_.push_back(static_cast<std::uint16_t>(code)); }
  void put32(std::uint32_t code);
  std::uint32_t fill(std::string_view bits);
  void put(std::string_view bits);
  void setRegister(std::uint32_t number, std::uint32_t value);

  void one(Drawn drawn);
  void data16();
  void data32();
  void multiply();
  void field();
  void single();
  void indexed(std::uint32_t opcode, std::uint32_t target, std::uint32_t base);
  void multiple();
  void dual(std::uint32_t base);
  void exclusive(std::uint32_t base);
  void ifThen();
  void branch();
  void table();
  void loop();

  CounterRandom random_;
  std::uint64_t drawn_{};
  std::vector<std::uint16_t> code_;
};

}  // namespace kerfbench::cortex_m_child
