// SPDX-License-Identifier: Apache-2.0
// The core by itself: encodings that are none, alignment, division by zero, IT, code that changes.
#include "hil/source/cortex_m_child/core.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

namespace kerfbench::cortex_m_child {
namespace {

/// A device of one register at 0x40000000.
class OneRegister final : public CoreBus {
 public:
  std::optional<std::uint32_t> readDevice(std::uint32_t address, unsigned /*bytes*/) override {
    if (address != kDeviceBase) return {};
    return value;
  }
  bool writeDevice(std::uint32_t address, unsigned /*bytes*/, std::uint32_t written) override {
    value = written;
    return address == kDeviceBase;
  }
  bool writeFlash(std::uint32_t /*offset*/, unsigned /*bytes*/, std::uint32_t /*value*/) override {
    return true;
  }
  std::uint32_t value{};
};

class CortexMCore : public testing::Test {
 protected:
  /// Runs half-words from the flash's start on, up to a stop.
  Stop run(const std::vector<std::uint16_t>& code, std::uint32_t begin = kFlashBase) {
    std::memcpy(flash_.data(), code.data(), 2 * code.size());
    core_.forgetCode(kFlashBase, static_cast<std::uint32_t>(flash_.size()));
    core_.setLimit(present_.cycle + 100'000);
    core_.jump(begin);
    return core_.run();
  }
  Stop runOne(std::uint32_t first, std::uint32_t second = kBreakpoint) {
    return run(
        {static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(second), kBreakpoint, kBreakpoint});
  }

  static constexpr std::uint16_t kBreakpoint = 0xBE00;
  Present present_;
  OneRegister bus_;
  std::vector<std::uint8_t> flash_ = std::vector<std::uint8_t>(0x400, 0xFF);
  std::vector<std::uint8_t> sram_ = std::vector<std::uint8_t>(0x400);
  Core core_{present_, bus_, flash_, sram_, {}};
};

TEST_F(CortexMCore, EncodingsThatAreNoneAreToldAsSuch) {
  const std::pair<std::uint32_t, std::uint32_t> none[] = {
      {0xDE00, 0},        // UDF
      {0xB400, 0xBF00},   // PUSH of nothing
      {0xBFF8, 0xBF00},   // IT NV
      {0x4500, 0xBF00},   // CMP of two low registers in the form for high ones
      {0xF3EF, 0x8004},   // MRS of a register that there is not
      {0xE8BD, 0x0001},   // LDM of one
      {0xE8A0, 0x0003},   // STM of its base with writeback
      {0xE8B0, 0xC002},   // LDM of LR and PC
      {0xE9D0, 0x0000},   // LDRD twice to one register
      {0xF850, 0x0B04},   // LDR of its base with writeback
      {0xF8C0, 0xF000},   // STR of the PC
      {0xFB80, 0x0001},   // SMULL to one register
      {0xF361, 0x0040},   // BFI from bit 1 to bit 0
      {0xF3A0, 0x0000},   // USAT16
      {0xFA80, 0xF001},   // SADD8
      {0xEC51, 0x0B10},   // VMOV
      {0xEE00, 0x0A10},   // VMOV
      {0xF04F, 0x0D00},   // MOV.W to SP
      {0xEB00, 0x0F01}};  // ADD.W to the PC
  for (const auto& [first, second] : none) {
    EXPECT_EQ(runOne(first, second), Stop::kUndefined) << std::hex << first << ' ' << second;
    EXPECT_EQ(core_.pc(), kFlashBase);
  }
}

TEST_F(CortexMCore, ABranchWithinAnItIsNone) {
  EXPECT_EQ(run({0xBF04, 0x4770, 0x2001, kBreakpoint}), Stop::kTrap) << "EQ does not hold";
  core_.setFlags(1U << 30U);
  EXPECT_EQ(run({0xBF04, 0x4770, 0x2001, kBreakpoint}), Stop::kUndefined);
  core_.set(kLr, kFlashBase + 9);
  EXPECT_EQ(run({0xBF04, 0x2001, 0x4770, kBreakpoint, kBreakpoint}), Stop::kTrap);
  EXPECT_EQ(core_.pc(), kFlashBase + 8) << "the last one may be a branch";
}

TEST_F(CortexMCore, WordsOfSeveralMustBeAligned) {
  const std::pair<std::uint32_t, std::uint32_t> several[] = {
      {0xC806, kBreakpoint}, {0xE9D0, 0x1200}, {0xE9C0, 0x1200}, {0xE850, 0x1F00}, {0xE890, 0x0006}};
  for (const auto& [first, second] : several) {
    core_.set(0, kSramBase + 2);
    EXPECT_EQ(runOne(first, second), Stop::kUnaligned) << std::hex << first;
    EXPECT_EQ(core_.faultAddress(), kSramBase + 2);
    EXPECT_EQ(core_.get(0), kSramBase + 2) << "the base stays";
  }
  sram_[2] = 0x78;
  sram_[5] = 0x12;
  EXPECT_EQ(runOne(0x6801), Stop::kTrap) << "LDR";
  EXPECT_EQ(core_.get(1), 0x12000078U);
  core_.setTraps(true, false);
  EXPECT_EQ(runOne(0x6801), Stop::kUnaligned);
  EXPECT_EQ(runOne(0x8801), Stop::kTrap) << "LDRH at an even address";
}

TEST_F(CortexMCore, DivisionByZeroIsZeroUnlessItIsToBeTold) {
  core_.set(0, 7);
  core_.set(1, 0);
  EXPECT_EQ(runOne(0xFBB0, 0xF2F1), Stop::kTrap);
  EXPECT_EQ(core_.get(2), 0U);
  core_.setTraps(false, true);
  EXPECT_EQ(runOne(0xFBB0, 0xF2F1), Stop::kDivisionByZero);
  EXPECT_EQ(runOne(0xFB90, 0xF2F1), Stop::kDivisionByZero);
}

TEST_F(CortexMCore, AnExclusiveStoreNeedsItsLoad) {
  core_.set(0, kSramBase);
  core_.set(1, 5);
  EXPECT_EQ(run({0xE840, 0x1200, kBreakpoint}), Stop::kTrap);
  EXPECT_EQ(core_.get(2), 1U);
  EXPECT_EQ(sram_[0], 0U);
  EXPECT_EQ(run({0xE850, 0x3F00, 0xE840, 0x1200, 0xE840, 0x1400, kBreakpoint}), Stop::kTrap);
  EXPECT_EQ(core_.get(2), 0U);
  EXPECT_EQ(core_.get(4), 1U) << "once for each load";
  EXPECT_EQ(sram_[0], 5U);
}

TEST_F(CortexMCore, GoesOnBetweenAnItAndWhatDependsOnIt) {
  // ITTE EQ; MOV R0, 1; MRS R1, PRIMASK; MOV R2, 3; MOV R3, 4
  core_.setFlags(1U << 30U);
  ASSERT_EQ(run({0xBF06, 0x2001, 0xF3EF, 0x8110, 0x2203, 0x2304, kBreakpoint}), Stop::kTrap);
  EXPECT_EQ(core_.pc(), kFlashBase + 4);
  core_.set(2, 0);
  core_.continueBehind(4);
  EXPECT_NE(core_.ifThen(), 0U);
  ASSERT_EQ(core_.run(), Stop::kTrap);
  EXPECT_EQ(core_.pc(), kFlashBase + 12);
  EXPECT_EQ(core_.get(0), 1U);
  EXPECT_EQ(core_.get(2), 0U) << "the third one is for NE";
  EXPECT_EQ(core_.get(3), 4U);
}

TEST_F(CortexMCore, CodeInTheSramMayChangeItself) {
  // STRH R1, [R0]; ITT EQ; then two instructions, of which the second is what has been stored.
  const std::uint16_t code[] = {0x8001, 0xBF04, 0x2205, 0x2306, kBreakpoint};
  std::memcpy(sram_.data(), code, sizeof code);
  core_.setFlags(1U << 30U);
  for (std::uint16_t number = 6; number < 9; ++number) {
    core_.set(0, kSramBase + 6);
    core_.set(1, 0x2300U + number);
    core_.setLimit(present_.cycle + 1000);
    core_.jump(kSramBase);
    ASSERT_EQ(core_.run(), Stop::kTrap);
    EXPECT_EQ(core_.get(3), number);
  }
}

TEST_F(CortexMCore, AStoreThatBeginsBeforeTheFirstCodeOfTheSramChangesIt) {
  // Behind two bytes of data: MOVS R2, 5 or what a word over data and code has made of it.
  const std::uint16_t code[] = {0, 0x2205, kBreakpoint};
  std::memcpy(sram_.data(), code, sizeof code);
  const auto runCode = [&] {
    core_.setLimit(present_.cycle + 1000);
    core_.jump(kSramBase + 2);
    return core_.run();
  };
  ASSERT_EQ(runCode(), Stop::kTrap);
  ASSERT_EQ(core_.get(2), 5U);
  core_.set(0, kSramBase);
  core_.set(1, 0x22060000);
  ASSERT_EQ(runOne(0x6001), Stop::kTrap);  // STR R1, [R0]
  ASSERT_EQ(runCode(), Stop::kTrap);
  EXPECT_EQ(core_.get(2), 6U);
}

TEST_F(CortexMCore, MoreItsThanThereArePlacesForAreDecodedAgain) {
  // A loop over an IT whose condition the loop itself changes, as often as to use up all places twice.
  const std::uint16_t code[] = {0x8001, 0xBF08, 0x3201, 0x3B01, 0xD1FA, kBreakpoint};
  std::memcpy(sram_.data(), code, sizeof code);
  constexpr std::uint32_t kTimes = 2 * Processor::kBlocks + 5;
  core_.set(0, kSramBase + 2);
  core_.set(1, 0xBF18);  // IT NE
  core_.set(2, 0);
  core_.set(3, kTimes);
  core_.setFlags(0);
  core_.setLimit(present_.cycle + 1'000'000);
  core_.jump(kSramBase);
  ASSERT_EQ(core_.run(), Stop::kTrap);
  EXPECT_EQ(core_.get(2), kTimes);
}

TEST_F(CortexMCore, PassesOverALoopThatWaitsInItsOwnTime) {
  // 1: LDR R1, [R0]; BL 2f; CMP R1, 0; BEQ 1b ... 2: ADDS R2, R1, 1; BX LR, over four lines of the flash.
  const std::vector<std::uint16_t> code{0x6801, 0xF000, 0xF806, 0x2900, 0xD0FA, 0xBE00,
                                        0xBF00, 0xBF00, 0xBF00, 0x1C4A, 0x4770};
  core_.setFlashTiming(2, true);
  core_.set(0, kSramBase);
  ASSERT_EQ(run(code), Stop::kLimit);
  const Cycle whole = present_.cycle;
  const std::uint32_t pc = core_.pc();
  EXPECT_GE(whole, 100'000U);
  present_.cycle = 0;
  core_.jump(kFlashBase);
  while (present_.cycle < 100'000) {
    core_.setLimit(std::min<Cycle>(present_.cycle + 5, 100'000));
    ASSERT_EQ(core_.run(), Stop::kLimit);
  }
  EXPECT_EQ(present_.cycle, whole);
  EXPECT_EQ(core_.pc(), pc);
}

TEST_F(CortexMCore, AlsoRunsWhereTheFlashIsAtZero) {
  EXPECT_EQ(run({0xA001, kBreakpoint}, 0), Stop::kTrap);
  EXPECT_EQ(core_.get(0), 8U) << "ADR of this address";
  EXPECT_EQ(run({0xA001, kBreakpoint}), Stop::kTrap);
  EXPECT_EQ(core_.get(0), kFlashBase + 8);
}

TEST_F(CortexMCore, StopsAtTheEndOfTheMemory) {
  std::fill(flash_.begin(), flash_.end(), std::uint8_t{0});
  EXPECT_EQ(run({0xBF00}, kFlashBase + 0x3F0), Stop::kBadFetch);
  EXPECT_EQ(core_.faultAddress(), kFlashBase + 0x400);
  flash_[0x3FF] = 0xF0;
  core_.forgetCode(kFlashBase, 0x400);
  core_.jump(kFlashBase + 0x3FE);
  EXPECT_EQ(core_.run(), Stop::kBadFetch) << "half of a wide instruction";
}

}  // namespace
}  // namespace kerfbench::cortex_m_child
