// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace kerfbench::mcs51_child {

/// Programs of slots: each sets registers and memory, carries out some instructions, and leaves what they
/// have made of it in external RAM.
class Slots {
 public:
  static constexpr std::size_t kResultBytes = 72;  ///< Internal RAM 0 to 3F, and eight registers.
  static constexpr std::uint16_t kStop = 0xFFF0;   ///< The program ends here.

  Slots();
  /// Adds a slot with these opcodes, operands drawn at random. Returns false if no room is left.
  bool add(const std::vector<std::uint8_t>& opcodes, std::mt19937& random);
  /// Ends the program. No slot can be added afterwards.
  const std::vector<std::uint8_t>& finish();
  [[nodiscard]] std::size_t size() const { return count_; }
  /// Bytes of code of a slot, for messages.
  [[nodiscard]] std::string textOf(std::size_t slot) const;

  /// Result of a slot in external RAM, and what it says.
  static std::array<std::uint8_t, kResultBytes> resultOf(std::size_t slot,
                                                         const std::vector<std::uint8_t>& xram);
  static std::string textOfResult(const std::array<std::uint8_t, kResultBytes>& result);

 private:
  void put(std::initializer_list<unsigned> bytes);
  void putPrologue(std::mt19937& random);
  void putInstruction(std::uint8_t opcode, std::mt19937& random);
  void putJump(std::uint8_t opcode, std::mt19937& random);
  void putEpilogue();
  void putFixed();

  std::vector<std::uint8_t> code_;
  std::size_t at_{};
  std::size_t count_{};
  std::vector<std::pair<std::size_t, std::size_t>> bodies_;
};

}  // namespace kerfbench::mcs51_child
