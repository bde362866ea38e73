// SPDX-License-Identifier: GPL-3.0-or-later
// Our core against simavr's own: each code of an instruction, with drawn registers, flags, pointers and
// memory, leaves the same machine at the same cycle.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <iomanip>
#include <sstream>

#include "tests/hil/source/avr_core/tested_avr.h"
#include "twin/base/random.h"

namespace kerfbench::avr_child {
namespace {

/// What an instruction finds.
struct Found {
  std::array<std::uint16_t, 3> code{};
  std::array<std::uint8_t, 32> registers{};
  std::uint16_t sp{};
  std::uint8_t sreg{};
  std::uint8_t rampz{};
};

class Drawing {
 public:
  Drawing(const avr_t& avr, std::uint64_t seed, std::uint64_t stream) : avr_(avr), random_(seed, stream) {}

  Found found(std::uint16_t code) {
    Found f;
    f.code = {code, static_cast<std::uint16_t>(bits()), static_cast<std::uint16_t>(bits())};
    for (auto& value : f.registers) value = byte();
    for (const unsigned pointer : {R_XL, R_YL, R_ZL}) {
      const std::uint16_t address = this->address();
      f.registers[pointer] = static_cast<std::uint8_t>(address);
      f.registers[pointer + 1] = static_cast<std::uint8_t>(address >> 8U);
    }
    f.sp = address();
    f.sreg = static_cast<std::uint8_t>(bits());
    f.rampz = static_cast<std::uint8_t>(below(avr_.flashend >> 16U));
    return f;
  }

 private:
  std::uint64_t bits() { return random_.bits(drawn_++); }
  std::uint32_t below(std::uint32_t bound) { return static_cast<std::uint32_t>(bits() >> 20U) % (bound + 1); }

  /// Numbers that instructions tend to be wrong with come more often than others.
  std::uint8_t byte() {
    constexpr std::uint8_t kEdges[] = {0, 1, 0x0F, 0x10, 0x7F, 0x80, 0xFF, 0xF0};
    const std::uint64_t drawn = bits();
    return (drawn >> 60U) < 6 ? kEdges[drawn & 7U] : static_cast<std::uint8_t>(drawn >> 8U);
  }

  /// Mostly of the RAM, some of the registers, some at borders of memories.
  std::uint16_t address() {
    const std::uint32_t kind = below(15);
    const std::uint32_t ram = avr_.ioend + 1U;
    if (kind < 11) return static_cast<std::uint16_t>(ram + below(avr_.ramend - ram));
    if (kind < 13) return static_cast<std::uint16_t>(below(31));
    const std::array<std::uint32_t, 4> borders{0, 31, avr_.ioend, avr_.ramend};
    return static_cast<std::uint16_t>(borders[below(3)] - 2 + below(4));
  }

  const avr_t& avr_;
  CounterRandom random_;
  std::uint64_t drawn_{};
};

void give(TestedAvr& tested, const Found& found, std::uint32_t pc) {
  avr_t& avr = tested.avr();
  tested.put(pc, found.code.data(), found.code.size());
  std::copy(found.registers.begin(), found.registers.end(), avr.data);
  avr.data[R_SPL] = static_cast<std::uint8_t>(found.sp);
  avr.data[R_SPH] = static_cast<std::uint8_t>(found.sp >> 8U);
  if (avr.rampz != 0) avr.data[avr.rampz] = found.rampz;
  if (avr.eind != 0) avr.data[avr.eind] = 0;
  tested.setSreg(found.sreg);
  avr.state = cpu_Running;
  avr.interrupt_state = 0;
  avr.pc = pc;
}

std::string listed(const Found& found) {
  std::ostringstream text;
  text << std::hex << std::setfill('0');
  for (const std::uint16_t word : found.code) text << std::setw(4) << word << ' ';
  text << "SREG " << int{found.sreg} << " SP " << found.sp << " registers";
  for (const std::uint8_t value : found.registers) text << ' ' << std::setw(2) << int{value};
  return text.str();
}

/// What simavr takes for JMP or CALL, of two words, where an instruction is skipped: some ADIW, SBIW and
/// others.
bool isTakenForJump(std::uint16_t code) { return (code & 0xFC0CU) == 0x940CU && (code & 0xFE0CU) != 0x940CU; }

/// ST X to a register of X itself, which simavr writes back afterwards.
bool isStoredToItself(const Found& found) {
  const unsigned x = found.registers[R_XL] | unsigned{found.registers[R_XH]} << 8U;
  return (found.code[0] & 0xFE0FU) == 0x920CU && (x == R_XL || x == R_XH);
}

class EveryCode : public testing::TestWithParam<const char*> {
 protected:
  /// Each first word of an instruction, `times` over.
  void compareAll(std::uint64_t seed, unsigned times) {
    for (std::uint32_t code = 0; code < 0x10000; ++code) {
      Drawing drawing(ours_.avr(), seed, code);
      for (unsigned i = 0; i < times; ++i) {
        Found found = drawing.found(static_cast<std::uint16_t>(code));
        if (isTakenForJump(found.code[1])) found.code[1] = 0;
        if (isStoredToItself(found)) continue;
        give(ours_, found, kPc);
        give(theirs_, found, kPc);
        ours_.step();
        theirs_.step();
        ASSERT_EQ(difference(ours_, theirs_), "") << listed(found);
      }
    }
    EXPECT_EQ(std::memcmp(ours_.avr().flash, theirs_.avr().flash, ours_.avr().flashend + 1U), 0);
  }
  static constexpr std::uint32_t kPc = 0x1000;
  TestedAvr ours_{GetParam(), TestedAvr::By::kOurs};
  TestedAvr theirs_{GetParam(), TestedAvr::By::kSimavr};
};

TEST_P(EveryCode, DoesWhatSimavrSays) { compareAll(1, 4); }

INSTANTIATE_TEST_SUITE_P(Controllers, EveryCode, testing::Values("atmega2560", "atmega328p", "attiny85"));

class EveryCodeLong : public EveryCode {};

TEST_P(EveryCodeLong, DoesWhatSimavrSaysManyTimesOver) { compareAll(1000, 50); }

INSTANTIATE_TEST_SUITE_P(Controllers, EveryCodeLong, testing::Values("atmega2560", "atmega328p", "attiny85"));

class Skips : public testing::Test {
 protected:
  /// The address behind a skip of this instruction.
  std::uint32_t behind(std::uint16_t skipped) {
    TestedAvr tested("atmega328p", TestedAvr::By::kOurs);
    const std::array<std::uint16_t, 2> code{0x1000, skipped};  // CPSE r0, r0
    tested.put(0, code.data(), code.size());
    tested.avr().state = cpu_Running;
    tested.step();
    return tested.avr().pc;
  }
};

// simavr 1.6 takes 64 codes for JMP or CALL that are not.
TEST_F(Skips, PassOverOneWordOrTwoAsTheManualSays) {
  EXPECT_EQ(behind(0x969C), 4U);  // ADIW r26, 0x2C
  EXPECT_EQ(behind(0x970D), 4U);  // SBIW r24, 0x0D
  EXPECT_EQ(behind(0x940C), 6U);  // JMP
  EXPECT_EQ(behind(0x95FF), 6U);  // CALL
  EXPECT_EQ(behind(0x9000), 6U);  // LDS
  EXPECT_EQ(behind(0x93F0), 6U);  // STS
  EXPECT_EQ(behind(0x93FF), 4U);  // PUSH
}

TEST(Stores, ReachTheRegistersOfTheirOwnPointer) {
  TestedAvr tested("atmega328p", TestedAvr::By::kOurs);
  avr_t& avr = tested.avr();
  const std::uint16_t store = 0x921C;  // ST X, r1
  tested.put(0, &store, 1);
  avr.state = cpu_Running;
  avr.data[R_XL] = R_XL;
  avr.data[1] = 0x55;
  tested.step();
  EXPECT_EQ(avr.data[R_XL], 0x55);
}

// What was decoded is forgotten where the firmware itself writes to its flash, as a bootloader does.
TEST(Flash, ThatTheFirmwareErasesIsForgotten) {
  TestedAvr tested("atmega328p", TestedAvr::By::kOurs);
  avr_t& avr = tested.avr();
  const std::array<std::uint16_t, 2> old_code{0xE001, 0xE012};  // LDI r16, 1; LDI r17, 2
  // LDI r30, 0; LDI r31, 1; LDI r20, 3; OUT SPMCSR, r20; SPM
  const std::array<std::uint16_t, 5> eraser{0xE0E0, 0xE0F1, 0xE043, 0xBF47, 0x95E8};
  tested.put(0x100, old_code.data(), old_code.size());
  tested.put(0x1000, eraser.data(), eraser.size());
  avr.state = cpu_Running;
  avr.pc = 0x100;
  tested.step();
  tested.step();
  EXPECT_EQ(avr.data[16], 1);
  EXPECT_EQ(avr.data[17], 2);
  avr.data[17] = 0;
  avr.pc = 0x1000;
  for (std::size_t i = 0; i < eraser.size(); ++i) tested.step();
  ASSERT_EQ(avr.flash[0x100], 0xFF);
  avr.pc = 0x102;
  tested.step();  // 0xFFFF is SBRS r31, 7 with a bit that must be 0: no instruction.
  EXPECT_EQ(avr.data[17], 0);
}

// simavr reads by pointers wherever these lead.
TEST(Flash, BehindItsEndReadsAsZero) {
  for (const auto by : {TestedAvr::By::kOurs, TestedAvr::By::kSimavr}) {
    TestedAvr tested("atmega2560", by);
    avr_t& avr = tested.avr();
    const std::uint16_t elpm = 0x9016;  // ELPM r1, Z
    tested.put(0, &elpm, 1);
    avr.state = cpu_Running;
    avr.data[avr.rampz] = avr.data[R_ZL] = avr.data[R_ZH] = avr.data[1] = 0xFF;
    tested.step();
    EXPECT_EQ(avr.data[1], 0);
    EXPECT_EQ(avr.pc, 2U);
  }
}

}  // namespace
}  // namespace kerfbench::avr_child
