// SPDX-License-Identifier: Apache-2.0
// Cycles of instructions against the table of the Cortex-M3 (ARM 2010).
#include <gmock/gmock.h>

#include "tests/hil/source/cortex_m/cortex_m_run.h"

namespace kerfbench::source::cortex_m {
namespace {

struct Range {
  unsigned least{};
  unsigned most{};
};

using CortexMCycles = CortexM;

// P, the refill after a branch, is 1 to 3 cycles; where the table has a range, the sequence has one here.
TEST_F(CortexMCycles, OfSequencesAreThoseOfTheTable) {
  const std::map<std::string, Range> table{
      {"empty", {3, 3}},      // NOP 1 and the second reading's 2; taken off from all others
      {"nop4", {4, 4}},       //
      {"add_w", {1, 1}},      //
      {"mul", {1, 1}},        //
      {"mla", {2, 2}},        //
      {"umull", {3, 5}},      //
      {"umlal", {4, 7}},      //
      {"udiv", {2, 12}},      //
      {"ldr", {3, 3}},        // 2, and a NOP
      {"ldr3", {5, 5}},       // 2 + 1 + 1 pipelined, and a NOP
      {"ldr_chain", {6, 6}},  // 2 + 1 + 2, and a NOP: a MOV between ends the pipelining
      {"str", {1, 1}},        //
      {"str_reg", {3, 3}},    // MOV 1, 2
      {"ldrd", {4, 4}},       // 1 + 2, and a NOP
      {"ldm4", {6, 6}},       // 1 + 4, and a NOP
      {"stm4", {5, 5}},       // 1 + 4
      {"push_pop", {7, 7}},   // 1 + 2 twice, and a NOP
      {"pop_pc", {7, 9}},     // ADR 1, ORR 1, 1 + 1, 1 + 1 + P
      {"ldm_pc", {9, 11}},    // ADR 1, ORR 1, 1 + 2, 1 + 2 + P
      {"branch", {2, 4}},     // 1 + P
      {"not_taken", {3, 3}},  // CMP 1, 1, NOP 1
      {"taken", {3, 5}},      // CMP 1, 1 + P
      {"loop10", {30, 48}},   // MOVS 1, 10 SUBS, 9 times 1 + P, and 1
      {"it", {3, 4}},         // CMP 1, IT 0 or 1, two of one cycle, of which one is skipped
      {"it_load", {4, 5}},    // CMP 1, IT 0 or 1, two skipped, NOP
      {"call", {7, 15}},      // MOV 1, three branches of 1 + P, MOV 1
      {"mrs", {1, 2}},
  };
  auto options = optionsFor("cycles");
  options.clock_hz = 8'000'000;
  std::map<std::string, unsigned> measured;
  std::istringstream text(runWith(options, 1'000'000).uart);
  std::string name;
  for (unsigned cycles = 0; text >> name >> cycles;) measured[name] = cycles;
  ASSERT_EQ(measured.size(), table.size());
  EXPECT_EQ(measured["ldm_pc"] - measured["pop_pc"], 2U) << "a register more to store and to load";
  for (const auto& [sequence, range] : table) {
    ASSERT_TRUE(measured.contains(sequence)) << sequence;
    EXPECT_GE(measured[sequence], range.least) << sequence;
    EXPECT_LE(measured[sequence], range.most) << sequence;
  }
}

}  // namespace
}  // namespace kerfbench::source::cortex_m
