// SPDX-License-Identifier: Apache-2.0
// Each of the 255 opcodes, and long sequences of them, against s51 of Debian's sdcc-ucsim.
#include <gmock/gmock.h>

#include <map>
#include <random>

#include "hil/source/mcs51_child/part.h"
#include "tests/hil/source/mcs51/oracle.h"
#include "tests/hil/source/mcs51/slots.h"

namespace kerfbench::mcs51_child {
namespace {

constexpr std::uint8_t kUndefined = 0xA5;

/// A program that has run on both.
struct Compared {
  Slots slots;
  Memories theirs;
  Memories ours;
};

void runBoth(Compared& compared) {
  const auto& code = compared.slots.finish();
  compared.theirs = runS51(code, Slots::kStop);
  compared.ours = runOurs(code, Slots::kStop);
}

/// Everything that is not in the results of slots.
void expectEqualRest(const Compared& compared) {
  EXPECT_EQ(compared.ours.iram, compared.theirs.iram);
  EXPECT_EQ(compared.ours.xram, compared.theirs.xram);
  EXPECT_EQ(compared.ours.clocks, compared.theirs.clocks);
  for (const unsigned sfr : {0x80U, 0x81U, 0x82U, 0x83U, 0x90U, 0xA0U, 0xB0U, 0xD0U, 0xE0U, 0xF0U})
    EXPECT_EQ(compared.ours.sfr[sfr & 0x7FU], compared.theirs.sfr[sfr & 0x7FU]) << sfr;
}

void expectEqualSlot(const Compared& compared, std::size_t slot) {
  EXPECT_EQ(Slots::textOfResult(Slots::resultOf(slot, compared.ours.xram)),
            Slots::textOfResult(Slots::resultOf(slot, compared.theirs.xram)))
      << "after " << compared.slots.textOf(slot);
}

class Opcode : public ::testing::TestWithParam<int> {
 protected:
  static constexpr int kCases = 12;

  struct Place {
    std::size_t program;
    std::size_t slot;
  };

  static void SetUpTestSuite() {
    if (s51Program().empty()) return;
    std::mt19937 random(1980);
    programs_.emplace_back();
    for (int opcode = 0; opcode < 256; ++opcode) {
      if (opcode == kUndefined) continue;
      for (int i = 0; i < kCases; ++i) {
        if (!programs_.back().slots.add({static_cast<std::uint8_t>(opcode)}, random)) {
          programs_.emplace_back();
          programs_.back().slots.add({static_cast<std::uint8_t>(opcode)}, random);
        }
        places_[opcode].push_back({programs_.size() - 1, programs_.back().slots.size() - 1});
      }
    }
    for (Compared& compared : programs_) runBoth(compared);
  }
  static void TearDownTestSuite() {
    programs_.clear();
    places_.clear();
  }

  static std::vector<Compared> programs_;
  static std::map<int, std::vector<Place>> places_;
};
std::vector<Compared> Opcode::programs_;
std::map<int, std::vector<Opcode::Place>> Opcode::places_;

TEST_P(Opcode, LeavesRegistersFlagsAndMemoryAsS51Does) {
  if (s51Program().empty()) GTEST_SKIP() << "s51 (package sdcc-ucsim) is not installed";
  ASSERT_EQ(places_[GetParam()].size(), static_cast<std::size_t>(kCases));
  for (const Place& place : places_[GetParam()]) expectEqualSlot(programs_[place.program], place.slot);
}

INSTANTIATE_TEST_SUITE_P(Of, Opcode, ::testing::Range(0, 0xA5));
INSTANTIATE_TEST_SUITE_P(Of2, Opcode, ::testing::Range(0xA6, 0x100));

TEST_F(Opcode, AllTogetherLeaveTheRestAndTheTimeAsS51Does) {
  if (s51Program().empty()) GTEST_SKIP() << "s51 (package sdcc-ucsim) is not installed";
  ASSERT_GE(programs_.size(), 2U);
  for (const Compared& compared : programs_) expectEqualRest(compared);
}

TEST(OpcodeSequences, TenThousandDrawnAtRandomLeaveWhatS51Leaves) {
  if (s51Program().empty()) GTEST_SKIP() << "s51 (package sdcc-ucsim) is not installed";
  constexpr std::size_t kSequences = 10'000;
  constexpr std::size_t kLength = 12;
  std::mt19937 random(8051);
  std::size_t done = 0;
  while (done < kSequences && !HasFailure()) {
    Compared compared;
    std::vector<std::uint8_t> opcodes;
    do {
      opcodes.clear();
      while (opcodes.size() < kLength) {
        const auto opcode = static_cast<std::uint8_t>(random() & 0xFFU);
        if (opcode != kUndefined) opcodes.push_back(opcode);
      }
    } while (done + compared.slots.size() < kSequences && compared.slots.add(opcodes, random));
    runBoth(compared);
    for (std::size_t slot = 0; slot < compared.slots.size() && !HasFailure(); ++slot)
      expectEqualSlot(compared, slot);
    expectEqualRest(compared);
    done += compared.slots.size();
  }
  EXPECT_EQ(done, kSequences);
}

}  // namespace
}  // namespace kerfbench::mcs51_child
