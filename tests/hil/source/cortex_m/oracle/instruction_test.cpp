// SPDX-License-Identifier: GPL-2.0-or-later
// What instructions do, against Unicorn: drawn programs leave the same registers, flags and memory.
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "tests/hil/source/cortex_m/oracle/cores.h"
#include "tests/hil/source/cortex_m/oracle/drawn_program.h"

namespace kerfbench::cortex_m_child {
namespace {

constexpr std::uint32_t kSlotBytes = 0x400;
constexpr unsigned kSlots = kCodeBytes / kSlotBytes;
constexpr std::uint16_t kBreakpoint = 0xBE00;

struct Program {
  std::uint32_t begin{};
  std::uint32_t end{};
  std::vector<std::uint16_t> code;
};

std::string listed(const Program& program) {
  std::ostringstream text;
  text << std::hex << program.begin << ":";
  for (const std::uint16_t half : program.code) text << ' ' << half;
  return text.str();
}

std::string difference(const MachineState& ours, const MachineState& theirs) {
  std::ostringstream text;
  text << std::hex;
  for (std::size_t i = 0; i < ours.r.size(); ++i) {
    if (ours.r[i] != theirs.r[i])
      text << "R" << std::dec << i << std::hex << " " << ours.r[i] << " and Unicorn " << theirs.r[i] << "\n";
  }
  if (ours.flags != theirs.flags) text << "flags " << ours.flags << " and Unicorn " << theirs.flags << "\n";
  for (std::size_t i = 0; i < ours.sram.size(); ++i) {
    if (ours.sram[i] == theirs.sram[i]) continue;
    text << "at " << kDataBase + i << " " << int{ours.sram[i]} << " and Unicorn " << int{theirs.sram[i]}
         << "\n";
    break;
  }
  return text.str();
}

/// Numbers that instructions tend to be wrong with come more often than others.
std::uint32_t drawnWord(std::uint64_t bits) {
  constexpr std::uint32_t kEdges[] = {0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 31, 32, 33};
  const auto word = static_cast<std::uint32_t>(bits);
  return (bits >> 60U) < 5 ? kEdges[bits >> 40U & 7U] : word;
}

MachineState drawnState(std::uint64_t seed, std::uint64_t number) {
  const CounterRandom random(seed + 1, number);
  MachineState state;
  for (std::size_t i = 0; i < state.r.size(); ++i) state.r[i] = drawnWord(random.bits(i));
  state.r[13] = kDataBase + 0x4000;
  state.flags = static_cast<std::uint32_t>(random.bits(20)) & 0xF0000000U;
  state.sram.resize(kDataBytes);
  for (std::size_t i = 0; i < kDataBytes; i += 8) {
    const std::uint64_t bits = random.bits(100 + i);
    std::memcpy(&state.sram[i], &bits, sizeof bits);
  }
  return state;
}

/// As many programs as the image has places for, each run by both.
void compareImage(const std::vector<Drawn>& classes, std::uint64_t seed, unsigned programs, unsigned length) {
  std::vector<std::uint8_t> image(kCodeBytes, 0xFF);
  std::vector<Program> all;
  for (unsigned i = 0; i < programs; ++i) {
    Program program{kCodeBase + i * kSlotBytes, 0, DrawnProgram(seed, i).draw(classes, length)};
    program.end = program.begin + static_cast<std::uint32_t>(2 * program.code.size());
    program.code.push_back(kBreakpoint);
    ASSERT_LE(2 * program.code.size(), kSlotBytes);
    std::memcpy(&image[program.begin - kCodeBase], program.code.data(), 2 * program.code.size());
    all.push_back(std::move(program));
  }
  const auto ours = makeOurs(image);
  const auto theirs = makeUnicorn(image);
  for (unsigned i = 0; i < programs; ++i) {
    MachineState own = drawnState(seed, i);
    MachineState other = own;
    ASSERT_EQ(theirs->run(all[i].begin, all[i].end, other), "") << listed(all[i]);
    ASSERT_EQ(ours->run(all[i].begin, all[i].end, own), "") << listed(all[i]);
    ASSERT_EQ(difference(own, other), "") << "seed " << seed << ", program " << i << "\n" << listed(all[i]);
  }
}

class Instructions : public testing::TestWithParam<Drawn> {};

TEST_P(Instructions, OfAClassDoWhatUnicornSays) {
  compareImage({GetParam()}, 100 + static_cast<std::uint64_t>(GetParam()), kSlots, 12);
}

INSTANTIATE_TEST_SUITE_P(Classes, Instructions, testing::ValuesIn(kAllDrawn));

TEST(InstructionsMixed, DoWhatUnicornSays) {
  compareImage({std::begin(kAllDrawn), std::end(kAllDrawn)}, 1, kSlots, 24);
}

TEST(InstructionsLong, OfManyProgramsDoWhatUnicornSays) {
  for (std::uint64_t seed = 1000; seed < 1060 && !HasFailure(); ++seed)
    compareImage({std::begin(kAllDrawn), std::end(kAllDrawn)}, seed, kSlots, 24);
}

}  // namespace
}  // namespace kerfbench::cortex_m_child
