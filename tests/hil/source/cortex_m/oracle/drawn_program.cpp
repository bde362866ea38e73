// SPDX-License-Identifier: GPL-2.0-or-later
#include "tests/hil/source/cortex_m/oracle/drawn_program.h"

#include <bit>

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kSp = 13, kLr = 14, kPc = 15;
constexpr std::uint32_t kMiddle = 0x20002000;
/// AL, NV and the like are no conditions of an instruction.
constexpr std::uint32_t kConditions = 14;

}  // namespace

std::uint32_t DrawnProgram::below(std::uint32_t bound) {
  return static_cast<std::uint32_t>(random_.bits(drawn_++) >> 16U) % bound;
}

/// Any register but SP and PC.
std::uint32_t DrawnProgram::ordinary() {
  const std::uint32_t number = below(14);
  return number == 13 ? kLr : number;
}

void DrawnProgram::put32(std::uint32_t code) {
  put16(code >> 16U);
  put16(code & 0xFFFFU);
}

/// Bits as they are; x: any; four letters r in a row: a register that is neither SP nor PC.
std::uint32_t DrawnProgram::fill(std::string_view bits) {
  std::uint32_t code = 0;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    if (bits[i] == ' ') continue;
    if (bits.substr(i, 4) == "rrrr") {
      code = code << 4U | ordinary();
      i += 3;
    } else {
      code = code << 1U | (bits[i] == 'x' ? below(2) : bits[i] == '1' ? 1U : 0U);
    }
  }
  return code;
}

void DrawnProgram::put(std::string_view bits) {
  std::size_t width = 0;
  for (const char c : bits) width += c == ' ' ? 0 : 1;
  if (width == 16) put16(fill(bits));
  if (width == 32) put32(fill(bits));
}

/// MOVW and MOVT.
void DrawnProgram::setRegister(std::uint32_t number, std::uint32_t value) {
  const auto move = [&](std::uint32_t opcode, std::uint32_t half) {
    put32(opcode | (half >> 11U & 1U) << 26U | half >> 12U << 16U | (half >> 8U & 7U) << 12U | number << 8U |
          (half & 0xFFU));
  };
  move(0xF2400000, value & 0xFFFFU);
  move(0xF2C00000, value >> 16U);
}

void DrawnProgram::data16() {
  static constexpr std::string_view kKinds[] = {
      "000xxxxxxxxxxxxx", "001xxxxxxxxxxxxx", "010000xxxxxxxxxx", "10110010xxxxxxxx", "1011101000xxxxxx",
      "1011101001xxxxxx", "1011101011xxxxxx", "10100xxxxxxxxxxx", "10101xxxxxxxxxxx", "10110000xxxxxxxx",
      "0100010000xxxxxx", "0100010001rrrrxx", "0100011000xxxxxx", "010001100xrrrrxx", "01000101x1xxxxxx"};
  const std::string_view kind = oneOf(kKinds);
  std::uint32_t code = fill(kind);
  if (kind.starts_with("010001010") || kind.starts_with("01000101x")) {
    // CMP of one high register at least, and not the PC.
    code = 0x4500U | ordinary() << 3U | (8U + below(5)) % 8U | 0x80U;
  } else if ((code & 0xFC00U) == 0x4400U && ((code >> 3U & 0xFU) == kPc)) {
    code ^= 0x08U;
  }
  put16(code);
}

void DrawnProgram::data32() {
  static constexpr std::uint32_t kOperations[] = {0, 1, 2, 3, 4, 8, 10, 11, 13, 14};
  const std::uint32_t operation = oneOf(kOperations) << 21U | below(2) << 20U;
  std::uint32_t n = ordinary();
  std::uint32_t d = ordinary();
  const std::uint32_t code = operation >> 21U;
  if ((code == 2 || code == 3) && chance(64)) n = kPc;
  if (code == 0 || code == 4 || code == 8 || code == 13) {
    if ((operation >> 20U & 1U) != 0 && chance(64)) d = kPc;
  }
  if (chance(100)) {
    std::uint32_t number = below(0x1000);
    if ((number >> 8U) != 0 && (number >> 10U) == 0 && (number & 0xFFU) == 0) number |= 1U;
    put32(0xF0000000U | operation | n << 16U | (number >> 11U) << 26U | (number >> 8U & 7U) << 12U | d << 8U |
          (number & 0xFFU));
  } else if (chance(150)) {
    put32(0xEA000000U | operation | n << 16U | below(8) << 12U | d << 8U | below(16) << 4U | ordinary());
  } else {
    static constexpr std::string_view kKinds[] = {
        "11110x100000 rrrr 0xxx rrrr xxxxxxxx", "11110x101010 rrrr 0xxx rrrr xxxxxxxx",
        "11110x100000 1111 0xxx rrrr xxxxxxxx", "11110x101010 1111 0xxx rrrr xxxxxxxx",
        "11110x100100 xxxx 0xxx rrrr xxxxxxxx", "11110x101100 xxxx 0xxx rrrr xxxxxxxx",
        "111110100xxx rrrr 1111 rrrr 0000 rrrr"};
    put(oneOf(kKinds));
  }
}

void DrawnProgram::multiply() {
  static constexpr std::string_view kKinds[] = {
      "111110110000 rrrr rrrr rrrr 0000 rrrr", "111110110000 rrrr 1111 rrrr 0000 rrrr",
      "111110110000 rrrr rrrr rrrr 0001 rrrr", "111110111001 rrrr 1111 rrrr 1111 rrrr",
      "111110111011 rrrr 1111 rrrr 1111 rrrr", "0100001101xxxxxx"};
  if (chance(130)) return put(oneOf(kKinds));
  const std::uint32_t low = ordinary();
  std::uint32_t high = ordinary();
  while (high == low) high = ordinary();
  put32(0xFB800000U | below(4) << 21U | ordinary() << 16U | low << 12U | high << 8U | ordinary());
}

/// Fields of bits, saturation, extension, reversal.
void DrawnProgram::field() {
  const std::uint32_t shift = below(32);
  const std::uint32_t split = (shift >> 2U) << 12U | (shift & 3U) << 6U;
  const std::uint32_t registers = ordinary() << 16U | ordinary() << 8U;
  switch (below(6)) {
    case 0:
      return put32(0xF3400000U | below(2) << 23U | registers | split | below(32 - shift));
    case 1:
      return put32(0xF3600000U | registers | split | (shift + below(32 - shift)));
    case 2:
      return put32(0xF36F0000U | (registers & 0xF00U) | split | (shift + below(32 - shift)));
    case 3:
      return put32(0xF3000000U | below(2) << 23U | (shift != 0 ? below(2) << 21U : 0U) | registers | split |
                   below(32));
    case 4: {
      static constexpr std::uint32_t kExtensions[] = {0, 1, 4, 5};
      return put32(0xFA0FF080U | oneOf(kExtensions) << 20U | (registers & 0xF00U) | below(4) << 4U |
                   ordinary());
    }
    default: {
      const std::uint32_t m = ordinary();
      const std::uint32_t kind = below(5);
      if (kind == 4) return put32(0xFAB0F080U | m << 16U | (registers & 0xF00U) | m);
      return put32(0xFA90F080U | kind << 4U | m << 16U | (registers & 0xF00U) | m);
    }
  }
}

void DrawnProgram::indexed(std::uint32_t opcode, std::uint32_t target, std::uint32_t base) {
  const std::uint32_t both = opcode | base << 16U | target << 12U;
  static constexpr std::uint32_t kIndexed[] = {0xC, 0x9, 0xB, 0xD, 0xF, 0xE};
  switch (below(3)) {
    case 0:
      return put32(both | 0x00800000U | below(0x1000));
    case 1: {
      const std::uint32_t index = oneOf(kIndexed);
      return put32(both | (base == target ? 0xCU : index) << 8U | below(256));
    }
    default: {
      std::uint32_t offset = ordinary();
      while (offset == base) offset = ordinary();
      setRegister(offset, below(0x200));
      return put32(both | below(4) << 4U | offset);
    }
  }
}

void DrawnProgram::single() {
  const std::uint32_t address = kMiddle + below(0x400);
  const bool is_narrow = chance(110);
  const std::uint32_t base = is_narrow ? below(8) : ordinary();
  setRegister(base, address);
  if (is_narrow) {
    const std::uint32_t low = base << 3U | below(8);
    if (chance(128)) return put16((0x6000U + (below(6) << 11U)) | below(32) << 6U | low);
    const std::uint32_t offset = (base + 1 + below(7)) % 8;
    setRegister(offset, below(0x100));
    return put16(0x5000U | below(8) << 9U | offset << 6U | low);
  }
  if (chance(40)) {
    setRegister(base, address & ~3U);  // Unicorn keeps bits 0 and 1 of SP, which the silicon has not.
    put16(0x4685U | base << 3U);       // MOV SP
    return put16(0x9000U | below(2) << 11U | below(8) << 8U | below(128));
  }
  if (chance(40)) return put16(0x4800U | below(8) << 8U | below(8));
  static constexpr std::uint32_t kOpcodes[] = {0xF8000000, 0xF8100000, 0xF8200000, 0xF8300000,
                                               0xF8400000, 0xF8500000, 0xF9100000, 0xF9300000};
  indexed(oneOf(kOpcodes), ordinary(), base);
}

void DrawnProgram::dual(std::uint32_t base) {
  std::uint32_t first = ordinary();
  std::uint32_t second = ordinary();
  while (first == base) first = ordinary();
  while (second == base || second == first) second = ordinary();
  static constexpr std::uint32_t kForms[] = {0xE9400000, 0xE9600000, 0xE8600000};
  put32(oneOf(kForms) | below(2) << 23U | below(2) << 20U | base << 16U | first << 12U | second << 8U |
        below(64));
}

void DrawnProgram::exclusive(std::uint32_t base) {
  const std::uint32_t form = below(3);
  static constexpr std::uint32_t kLoads[] = {0xE8500F00, 0xE8D00F4F, 0xE8D00F5F};
  static constexpr std::uint32_t kStores[] = {0xE8400000, 0xE8C00F40, 0xE8C00F50};
  std::uint32_t loaded = ordinary();
  while (loaded == base) loaded = ordinary();
  std::uint32_t result = ordinary();
  while (result == base || result == loaded) result = ordinary();
  const std::uint32_t offset = form == 0 ? below(64) : 0;
  if (chance(200)) put32(kLoads[form] | base << 16U | loaded << 12U | offset);
  if (chance(40)) put32(0xF3BF8F2F);  // CLREX
  put32(kStores[form] | base << 16U | loaded << 12U | (form == 0 ? result << 8U : result) | offset);
}

void DrawnProgram::multiple() {
  const std::uint32_t base = below(8);
  const std::uint32_t kind = below(5);
  setRegister(base, kMiddle + 4 * below(0x100));
  if (kind == 0) return dual(base);
  if (kind == 1) return exclusive(base);
  std::uint32_t list = 1 + below(0xFF);
  if (kind == 2) {
    if (chance(128)) list &= ~(1U << base);
    if (list == 0) list = base == 0 ? 2 : 1;
    const bool is_load = chance(128);
    // A base that is stored and not the first of the list is stored as an unknown value.
    if (!is_load && (list & ((1U << base) - 1)) != 0) list &= ~(1U << base);
    if (list == 0) list = base == 0 ? 2 : 1;
    return put16(0xC000U | (is_load ? 0x800U : 0U) | base << 8U | list);
  }
  if (kind == 3) {
    put16(0x4685U | base << 3U);
    put16(chance(128) ? 0xB400U | below(2) << 8U | list : 0xBC00U | list);
    return;
  }
  list |= below(0x20) << 8U | below(2) << 14U;
  list &= ~(1U << base);
  while (std::popcount(list) < 2) list |= 1U << (base ^ (1U + below(7)));
  list &= ~(1U << base);
  if (std::popcount(list) < 2) list |= 0x0C00U;
  const std::uint32_t direction = chance(128) ? 0xE8800000U : 0xE9000000U;
  put32(direction | below(2) << 21U | below(2) << 20U | base << 16U | list);
}

/// Up to four instructions that depend on a condition or its opposite.
void DrawnProgram::ifThen() {
  const std::uint32_t condition = below(kConditions);
  const std::uint32_t count = 1 + below(4);
  // The lowest 1 ends the list; above it are the low bits of the conditions.
  std::uint32_t bits = 0;
  for (std::uint32_t i = 1; i < count; ++i) bits = bits << 1U | below(2);
  const std::uint32_t mask = (bits << 1U | 1U) << (4 - count);
  put16(0xBF00U | condition << 4U | mask);
  for (std::uint32_t i = 0; i < count; ++i) {
    switch (below(4)) {
      case 0:
        data16();
        break;
      case 1:
        data32();
        break;
      case 2:
        field();
        break;
      default:
        multiply();
        break;
    }
  }
}

/// TBB or TBH over four ways, of which each is shorter than the one before.
void DrawnProgram::table() {
  const std::uint32_t index = below(8);
  const bool is_wide = chance(128);
  setRegister(index, below(4));
  put32(0xE8DFF000U | (is_wide ? 0x10U : 0U) | index);
  for (std::uint32_t i = 0; i < 4; i += is_wide ? 1 : 2) put16(is_wide ? 4 + i : (2 + i) | (3 + i) << 8U);
  for (unsigned i = 0; i < 4; ++i) put("001xxxxxxxxxxxxx");
}

/// Counts down R7.
void DrawnProgram::loop() {
  put16(0x2700U | (1 + below(20)));
  const std::size_t begin = code_.size();
  for (unsigned i = 0; i < 3; ++i) put("00000xxxxx xxx 0xx");
  put16(0x3F01U);
  const auto back = static_cast<std::uint32_t>(begin - code_.size() - 2);
  put16(0xD100U | (back & 0xFFU));
}

/// Forwards over a few narrow instructions, in each form that there is.
void DrawnProgram::branch() {
  const std::uint32_t over = 1 + below(4);
  const std::uint32_t condition = below(kConditions);
  switch (below(8)) {
    case 0:
      put16(0xD000U | condition << 8U | (over - 1));
      break;
    case 1:
      put16(0xE000U | (over - 1));
      break;
    case 2:
      put16(0xB100U | below(2) << 11U | (over - 1) << 3U | below(8));
      break;
    case 3:
      put32(0xF0008000U | condition << 22U | over);
      break;
    case 4:
      put32((chance(128) ? 0xF000F800U : 0xF000B800U) | over);
      break;
    case 5:
      put32(0xF20F0001U | below(8) << 8U | (2 * over + 8 - (code_.size() % 2 == 0 ? 2 : 0)));
      put16(0xBF00);
      put16(0xBF00);
      break;
    case 6:
      return table();
    default:
      return loop();
  }
  for (std::uint32_t i = 0; i < over; ++i) put("001xxxxxxxxxxxxx");
}

void DrawnProgram::one(Drawn drawn) {
  switch (drawn) {
    case Drawn::kData16:
      return data16();
    case Drawn::kData32:
      return data32();
    case Drawn::kMultiply:
      return multiply();
    case Drawn::kField:
      return field();
    case Drawn::kSingle:
      return single();
    case Drawn::kMultiple:
      return multiple();
    case Drawn::kIfThen:
      return ifThen();
    case Drawn::kBranch:
      return branch();
  }
}

std::vector<std::uint16_t> DrawnProgram::draw(const std::vector<Drawn>& classes, unsigned instructions) {
  for (unsigned i = 0; i < instructions; ++i) one(classes[below(static_cast<std::uint32_t>(classes.size()))]);
  return std::move(code_);
}

}  // namespace kerfbench::cortex_m_child
