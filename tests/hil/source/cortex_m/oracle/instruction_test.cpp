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

/// An image of drawn programs, each in a slot of its own.
struct Image {
  Image(const std::vector<Drawn>& classes, std::uint64_t seed, unsigned length) : bytes(kCodeBytes, 0xFF) {
    for (unsigned i = 0; i < kSlots; ++i) {
      Program program{kCodeBase + i * kSlotBytes, 0, DrawnProgram(seed, i).draw(classes, length)};
      program.end = program.begin + static_cast<std::uint32_t>(2 * program.code.size());
      program.code.push_back(kBreakpoint);
      std::memcpy(&bytes.at(program.begin - kCodeBase), program.code.data(), 2 * program.code.size());
      EXPECT_LE(2 * program.code.size(), kSlotBytes);
      programs.push_back(std::move(program));
    }
  }
  std::vector<std::uint8_t> bytes;
  std::vector<Program> programs;
};

/// Each program of an image, run by both.
void compareImage(const std::vector<Drawn>& classes, std::uint64_t seed, unsigned length) {
  Image image(classes, seed, length);
  const auto ours = makeOurs(image.bytes);
  const auto theirs = makeUnicorn(image.bytes);
  for (unsigned i = 0; i < kSlots; ++i) {
    const Program& program = image.programs[i];
    MachineState own = drawnState(seed, i);
    MachineState other = own;
    ASSERT_EQ(theirs->run(program.begin, program.end, other), "") << listed(program);
    ASSERT_EQ(ours->run(program.begin, program.end, own), "") << listed(program);
    ASSERT_EQ(difference(own, other), "") << "seed " << seed << ", program " << i << "\n" << listed(program);
  }
}

class Instructions : public testing::TestWithParam<Drawn> {};

TEST_P(Instructions, OfAClassDoWhatUnicornSays) {
  compareImage({GetParam()}, 100 + static_cast<std::uint64_t>(GetParam()), 12);
}

INSTANTIATE_TEST_SUITE_P(Classes, Instructions, testing::ValuesIn(kAllDrawn));

TEST(InstructionsMixed, DoWhatUnicornSays) {
  compareImage({std::begin(kAllDrawn), std::end(kAllDrawn)}, 1, 24);
}

// How a run is cut changes nothing: what the core keeps at a stop is all that the time depends on.
TEST(InstructionsMixed, TakeTheSameTimeHoweverTheyAreCut) {
  Image image({std::begin(kAllDrawn), std::end(kAllDrawn)}, 2, 24);
  const auto whole = makeOurs(image.bytes);
  for (const std::uint64_t slice : {1U, 2U, 7U}) {
    const auto cut = makeOurs(image.bytes, slice);
    for (unsigned i = 0; i < kSlots; ++i) {
      const Program& program = image.programs[i];
      MachineState one = drawnState(2, i);
      MachineState other = one;
      ASSERT_EQ(whole->run(program.begin, program.end, one), "") << listed(program);
      ASSERT_EQ(cut->run(program.begin, program.end, other), "") << listed(program);
      ASSERT_EQ(difference(one, other), "") << listed(program);
      ASSERT_EQ(one.cycles, other.cycles) << "slices of " << slice << " cycles\n" << listed(program);
    }
  }
}

TEST(InstructionsLong, OfManyProgramsDoWhatUnicornSays) {
  for (std::uint64_t seed = 1000; seed < 1060 && !HasFailure(); ++seed)
    compareImage({std::begin(kAllDrawn), std::end(kAllDrawn)}, seed, 24);
}

}  // namespace
}  // namespace kerfbench::cortex_m_child
