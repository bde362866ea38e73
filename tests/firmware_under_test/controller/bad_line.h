// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <random>
#include <string_view>
#include <vector>

namespace kerfbench::controller_test {

/// One fault of a line.
struct Corruption {
  enum class Kind { kDrop, kRepeat, kFlip, kOverwrite, kInsert, kReplay, kDelay, kNoise };
  static constexpr int kKinds = 8;
  Kind kind{};
  std::size_t at_byte{};  ///< Number of the input byte at which the fault begins.
  std::size_t length{};   ///< Length in bytes; of a flip, in bits.
  std::uint64_t delay{};  ///< Delay in ticks, of kDelay.
  double share{};         ///< Share of the later bytes that are damaged, of kNoise.
};
std::string_view kindName(Corruption::Kind kind);

/// One direction of a serial line, with the given faults. Same seed, same bytes.
class BadLine {
 public:
  /// Makes a line. @pre events ascend in at_byte.
  BadLine(std::vector<Corruption> events, std::uint32_t seed);
  void put(std::uint8_t byte, std::uint64_t tick);
  /// Bytes that have come out by now.
  std::vector<std::uint8_t> take(std::uint64_t tick);
  [[nodiscard]] std::size_t bytesIn() const { return count_; }

 private:
  void begin(const Corruption& event, std::uint64_t tick);
  void out(std::uint8_t byte, std::uint64_t tick);
  void replay(std::size_t length, std::uint64_t tick);

  std::vector<Corruption> events_;
  std::size_t next_{};
  std::mt19937 random_;
  std::size_t count_{};
  std::size_t drop_{}, overwrite_{};
  unsigned flip_{};  ///< Bits of the present byte.
  double noise_{};
  std::uint64_t not_before_{};
  std::vector<std::uint8_t> history_;
  struct Waiting {
    std::uint64_t tick;
    std::uint8_t byte;
  };
  std::deque<Waiting> waiting_;
};

}  // namespace kerfbench::controller_test
