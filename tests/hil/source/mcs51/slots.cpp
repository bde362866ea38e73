// SPDX-License-Identifier: Apache-2.0
#include "tests/hil/source/mcs51/slots.h"

#include <algorithm>
#include <cstdio>

namespace kerfbench::mcs51_child {
namespace {

constexpr std::size_t kSave = 0xF700;      // Subroutine that copies a slot's result.
constexpr std::size_t kJumpPads = 0xF800;  // Targets of AJMP and ACALL, one in each 256 bytes.
constexpr std::size_t kRoomEnd = kSave - 256;
constexpr unsigned kSaved = 0x70;    // Internal RAM for eight registers.
constexpr unsigned kCounted = 0x3F;  // Counts the instructions that a jump has not skipped.
constexpr unsigned kStack = 0x9F;
constexpr std::array<unsigned, 8> kRegisters{0xD0, 0xE0, 0xF0, 0x82, 0x83, 0x81, 0x90, 0xA0};

unsigned pick(std::mt19937& random, unsigned below) { return static_cast<unsigned>(random() % below); }
unsigned byteOf(std::mt19937& random) { return pick(random, 256); }

/// A direct address to read: the RAM that results keep, or a register without peripheral.
unsigned sourceOf(std::mt19937& random) {
  constexpr std::array<unsigned, 7> kSfrs{0xE0, 0xF0, 0xD0, 0x82, 0x83, 0x90, 0x81};
  return pick(random, 3) != 0 ? 0x20 + pick(random, 0x20) : kSfrs[pick(random, 7)];
}

/// One to write. Not SP, for the program's own sake, and not PSW: s51 lets software write the parity.
unsigned targetOf(std::mt19937& random) {
  constexpr std::array<unsigned, 5> kSfrs{0xE0, 0xF0, 0x82, 0x83, 0x90};
  return pick(random, 3) != 0 ? 0x20 + pick(random, 0x20) : kSfrs[pick(random, 5)];
}

/// A bit to read, or one to write: not the parity, and not RS0 or RS1, after which s51 uses the old bank on.
unsigned bitOf(std::mt19937& random, bool is_target) {
  constexpr std::array<unsigned, 3> kSfrs{0xE0, 0xF0, 0x90};
  constexpr std::array<unsigned, 5> kFlags{0xD7, 0xD6, 0xD5, 0xD2, 0xD1};
  if (pick(random, 2) != 0) return pick(random, 0x80);
  if (pick(random, 4) != 0) return kSfrs[pick(random, 3)] + pick(random, 8);
  return is_target ? kFlags[pick(random, 5)] : 0xD0 + pick(random, 8);
}

bool isJump(std::uint8_t opcode) {
  const unsigned row = opcode >> 4U;
  const unsigned column = opcode & 0xFU;
  return column == 1 || (column == 0 && row >= 1 && row <= 8) || opcode == 0x02 || opcode == 0x12 ||
         opcode == 0x22 || opcode == 0x32 || opcode == 0x73 || (row == 0xB && column >= 4) ||
         opcode == 0xD5 || (row == 0xD && column >= 8);
}

}  // namespace

Slots::Slots() : code_(0x10000, 0) {
  put({0x02, 0x01, 0x00});  // LJMP 0100
  at_ = 0x100;
  putFixed();
}

void Slots::put(std::initializer_list<unsigned> bytes) {
  for (const unsigned byte : bytes) code_[at_++] = static_cast<std::uint8_t>(byte);
}

void Slots::putFixed() {
  const std::size_t start = at_;
  at_ = kSave;
  // Bank 3 is scratch: R0 points, R2 counts. First the RAM, then the registers.
  put({0x75, 0xD0, 0x18, 0x78, 0x00, 0x7A, 0x40});
  put({0xE6, 0xF0, 0xA3, 0x08, 0xDA, 0xFA});
  put({0x78, kSaved, 0x7A, 0x08});
  put({0xE6, 0xF0, 0xA3, 0x08, 0xDA, 0xFA, 0x22});
  for (unsigned k = 0; k < 8; ++k) {
    const std::size_t base = kJumpPads + k * 0x100;
    at_ = base + 0x40;
    put({0x05, kCounted, 0x22});  // INC counted; RET
    at_ = base + 0x48;
    put({0x05, kCounted, 0x32});  // INC counted; RETI
    at_ = base + 0x50;
    put({k << 5U | 0x01U, 0x40});  // AJMP to the pad
    at_ = base + 0x60;
    put({k << 5U | 0x11U, 0x40, 0x22});  // ACALL it; RET
  }
  at_ = kStop;
  put({0x80, 0xFE});
  at_ = start;
}

void Slots::putPrologue(std::mt19937& random) {
  put({0x75, 0x81, kStack, 0x75, 0xD0, byteOf(random) & 0xFEU});
  put({0x78, 0x20 + pick(random, 0x20), 0x79, 0x80 + pick(random, 0x70)});
  for (unsigned i = 2; i < 8; ++i) put({0x78U + i, byteOf(random)});
  for (unsigned i = 0; i < 6; ++i) put({0x75, 0x20 + pick(random, 0x20), byteOf(random)});
  put({0x76, byteOf(random), 0x77, byteOf(random)});
  put({0x75, 0xF0, byteOf(random), 0x90, byteOf(random), byteOf(random), 0x74, byteOf(random)});
}

void Slots::putJump(std::uint8_t opcode, std::mt19937& random) {
  const unsigned skip = 2;  // INC counted, behind each jump.
  const unsigned high = static_cast<unsigned>(kJumpPads >> 8U) + (opcode >> 5U);
  if ((opcode & 0x1FU) == 0x01) {
    put({0x12, high, 0x50});
  } else if ((opcode & 0x1FU) == 0x11) {
    put({0x12, high, 0x60});
  } else if (opcode == 0x12 || opcode == 0x22) {
    put({0x12, high, 0x40});
  } else if (opcode == 0x32) {
    put({0x12, high, 0x48});
  } else if (opcode == 0x02) {
    const auto target = static_cast<unsigned>(at_) + 3 + skip;
    put({opcode, target >> 8U, target & 0xFFU});
  } else if (opcode == 0x73) {
    const unsigned a = byteOf(random);
    const auto target = static_cast<unsigned>(at_) + 6 + skip - a;
    put({0x90, target >> 8U & 0xFFU, target & 0xFFU, 0x74, a, opcode});
  } else if (opcode <= 0x30) {
    put({opcode, bitOf(random, opcode == 0x10), skip});
  } else if (opcode == 0xB5 || opcode == 0xD5) {
    put({opcode, opcode == 0xB5 ? sourceOf(random) : targetOf(random), skip});
  } else if (opcode >> 4U == 0xB) {
    put({opcode, byteOf(random), skip});
  } else {
    put({opcode, skip});
  }
  put({0x05, kCounted});
}

void Slots::putInstruction(std::uint8_t opcode, std::mt19937& random) {
  const unsigned row = opcode >> 4U;
  const unsigned column = opcode & 0xFU;
  if (isJump(opcode)) {
    putJump(opcode, random);
  } else if (opcode == 0x84) {
    put({0x75, 0xF0, 1 + pick(random, 255), opcode});  // Intel leaves A and B undefined after 1/0.
  } else if (opcode == 0x90) {
    put({opcode, byteOf(random), byteOf(random)});
  } else if (opcode == 0x75 || opcode == 0x43 || opcode == 0x53 || opcode == 0x63) {
    put({opcode, targetOf(random), byteOf(random)});
  } else if (opcode == 0x85) {
    const unsigned source = sourceOf(random);
    put({opcode, source, targetOf(random)});
  } else if (opcode == 0x72 || opcode == 0x82 || opcode == 0xA0 || opcode == 0xB0 || opcode == 0xA2) {
    put({opcode, bitOf(random, false)});
  } else if (opcode == 0x92 || opcode == 0xB2 || opcode == 0xC2 || opcode == 0xD2) {
    put({opcode, bitOf(random, true)});
  } else if (opcode == 0x42 || opcode == 0x52 || opcode == 0x62 || opcode == 0xD0 || opcode == 0xC0 ||
             (row == 0x8 && column >= 6) || (column == 5 && (row < 2 || row == 0xC || row == 0xF))) {
    put({opcode, opcode == 0xC0 ? sourceOf(random) : targetOf(random)});
  } else if (column == 5 || (row == 0xA && column >= 6)) {
    put({opcode, sourceOf(random)});
  } else if ((column == 4 && row >= 2 && row != 8 && row < 0xA) || (row == 0x7 && column >= 6)) {
    put({opcode, byteOf(random)});
  } else {
    put({opcode});
  }
}

void Slots::putEpilogue() {
  for (unsigned i = 0; i < kRegisters.size(); ++i) put({0x85, kRegisters[i], kSaved + i});
  const auto result = static_cast<unsigned>(count_ * kResultBytes);
  put({0x75, 0x81, kStack, 0x75, 0xA0, 0xFF, 0x75, 0x90, 0xFF});
  put({0x90, result >> 8U, result & 0xFFU, 0x12, kSave >> 8U, kSave & 0xFFU});
}

bool Slots::add(const std::vector<std::uint8_t>& opcodes, std::mt19937& random) {
  if (at_ > kRoomEnd || (count_ + 1) * kResultBytes > 0xFE00) return false;
  putPrologue(random);
  const std::size_t begin = at_;
  for (const std::uint8_t opcode : opcodes) putInstruction(opcode, random);
  bodies_.emplace_back(begin, at_);
  putEpilogue();
  ++count_;
  return true;
}

const std::vector<std::uint8_t>& Slots::finish() {
  put({0x02, kStop >> 8U, kStop & 0xFFU});
  return code_;
}

std::string Slots::textOf(std::size_t slot) const {
  std::string text;
  char digits[4];
  for (std::size_t i = bodies_[slot].first; i < bodies_[slot].second; ++i) {
    std::snprintf(digits, sizeof digits, "%02x ", code_[i]);
    text += digits;
  }
  return text;
}

std::array<std::uint8_t, Slots::kResultBytes> Slots::resultOf(std::size_t slot,
                                                              const std::vector<std::uint8_t>& xram) {
  std::array<std::uint8_t, kResultBytes> result{};
  std::copy_n(xram.begin() + static_cast<std::ptrdiff_t>(slot * kResultBytes), kResultBytes, result.begin());
  return result;
}

std::string Slots::textOfResult(const std::array<std::uint8_t, kResultBytes>& result) {
  constexpr const char* kNames[] = {"psw", "a", "b", "dpl", "dph", "sp", "p1", "p2"};
  std::string text;
  char field[16];
  for (unsigned i = 0; i < kRegisters.size(); ++i) {
    std::snprintf(field, sizeof field, "%s=%02x ", kNames[i], result[64 + i]);
    text += field;
  }
  text += "ram:";
  for (unsigned i = 0; i < 64; ++i) {
    std::snprintf(field, sizeof field, " %02x", result[i]);
    text += field;
  }
  return text;
}

}  // namespace kerfbench::mcs51_child
