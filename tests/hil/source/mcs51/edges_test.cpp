// SPDX-License-Identifier: Apache-2.0
// Edges of port 1, one by one, against those that s51 records, and what both make of a write that Intel
// leaves no doubt about.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include "tests/hil/base/temp_folder.h"
#include "tests/hil/source/mcs51/oracle.h"
#include "tests/hil/source/mcs51/program.h"

namespace kerfbench::mcs51_child {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::Each;

struct Edge {
  std::uint64_t cycle{};
  unsigned level{};  ///< Port 1, its lower four bits.
  int instruction_cycles{};
};

/// Port 1 as s51 records it. s51 has two records of a port: "bits" shows what bit instructions write, "sfr"
/// what the others do; each misses the other's changes.
std::vector<Edge> edgesOfS51(const Program& program) {
  const base::TempFolder folder;
  const auto image = folder.write("image.ihx", intelHex(program.code()));
  const std::string vcd = (folder.path() / "edges.vcd").string();
  std::string script = "file \"" + image.string() + "\"\nset hw vcd[0] output \"" + vcd + "\"\n";
  for (unsigned bit = 0; bit < 4; ++bit) {
    script += "set hw vcd[0] add bits[" + std::to_string(0x90 + bit) + "]\n";
    script += "set hw vcd[0] add sfr[0x90]." + std::to_string(bit) + "\n";
  }
  // A line that the program comes to at its end.
  (void)askS51("-t 52 -X 12M", script + "set hw vcd[0] start\nrun 0 " + std::to_string(program.here() - 2) +
                                   "\nset hw vcd[0] stop\nquit\n");
  std::istringstream in(base::contentOf(vcd));
  std::map<std::string, unsigned> bits;
  std::map<std::uint64_t, unsigned> levels;
  unsigned level = 0xF;
  std::uint64_t cycle = 0;
  bool has_begun = false;
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    std::string word;
    fields >> word;
    if (word == "$var") {
      std::string name;
      std::string id;
      fields >> name >> name >> id >> name;
      bits[id] = static_cast<unsigned>(name.back() == '0' && name.find("bits") == 0
                                           ? std::stoul(name.substr(name.find("0x9") + 3, 1), nullptr, 16)
                                           : std::stoul(name.substr(name.size() - 1)));
    } else if (word.starts_with('#')) {
      cycle = std::stoull(word.substr(1)) / 1'000'000;
      has_begun = cycle > 0;
    } else if (has_begun && (word.starts_with('0') || word.starts_with('1'))) {
      const unsigned mask = 1U << bits.at(word.substr(1));
      level = word[0] == '1' ? level | mask : level & ~mask;
      levels[cycle] = level;
    }
  }
  std::vector<Edge> edges;
  for (const auto& [at, value] : levels) {
    const unsigned before = edges.empty() ? 0xF : edges.back().level;
    if (value != before) edges.push_back({at, value});
  }
  return edges;
}

/// Port 1 of our own, with the cycles of the instruction that has written it.
std::vector<Edge> edgesOfOurs(const Program& program, unsigned cycles) {
  Bench bench("80c52", program);
  std::vector<Edge> edges;
  while (bench.chip().now() < 12 * Tick{cycles}) {
    const Tick before = bench.chip().now();
    for (const auto& event : bench.runTo(before + 1)) {
      if (event.port != 1 || (event.changed & 0xF) == 0 || event.tick > 12 * Tick{cycles}) continue;
      edges.push_back({event.tick / 12, event.level & 0xFU, static_cast<int>((event.tick - before) / 12)});
    }
  }
  return edges;
}

void expectSameLevels(const std::vector<Edge>& ours, const std::vector<Edge>& theirs) {
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) EXPECT_EQ(ours[i].level, theirs[i].level) << "edge " << i;
}

/// Ours less theirs, in cycles. s51 says when the first cycle of a writing instruction ends; ours are at the
/// end of its last one, where the pin changes (Intel 1994): what is left are differences in the run.
std::vector<int> delays(const std::vector<Edge>& ours, const std::vector<Edge>& theirs) {
  std::vector<int> result;
  for (std::size_t i = 0; i < std::min(ours.size(), theirs.size()); ++i) {
    result.push_back(static_cast<int>(ours[i].cycle) - static_cast<int>(theirs[i].cycle) -
                     (ours[i].instruction_cycles - 1));
  }
  return result;
}

class Mcs51Edges : public ::testing::Test {
 protected:
  void SetUp() override {
    if (s51Program().empty()) GTEST_SKIP() << "s51 (package sdcc-ucsim) is not installed";
  }
};

/// Every way to write to a port, in a loop of changing length, and perhaps a wait for a polled timer.
Program manyWrites(bool polls) {
  Program p;
  p.mov(kTmod, 0x02).mov(kTl0, 200).mov(kTh0, 200).setb(kTr0).put({0x7F, 100});
  const unsigned loop = p.here();
  p.setb(kP1_0).clr(kP1_1).mov(kP1, 0xF5).cpl(kP1_2);
  p.put({0x53, kP1, 0xFE}).put({0x43, kP1, 0x08}).put({0x63, kP1, 0x03});
  p.movA(0xF0).put({0x42, kP1}).movA(0xFC).put({0x52, kP1}).movA(0x05).put({0x62, kP1});
  p.put({0x05, kP1}).put({0x15, kP1}).put({0xD3, 0x92, kP1_3}).put({0x10, kP1_3, 0x00});
  p.put({0xEF, 0xF5, kP1, 0x8F, kP1});  // MOV A,R7; MOV P1,A; MOV P1,R7
  p.put({0x8F, 0x30, 0x85, 0x30, kP1, 0x54, 0x07, 0x04, 0xFE});
  p.djnzR(6, p.here());
  if (polls) p.jnb(kTf0, p.here()).clr(kTf0);
  p.cpl(kP1_0);
  const unsigned end = p.here();
  p.djnzR(7, end + 4).sjmp(end + 7).ljmp(loop).halt();
  return p;
}

TEST_F(Mcs51Edges, OfEveryKindOfWriteAreThoseOfS51) {
  const Program program = manyWrites(false);
  const auto ours = edgesOfOurs(program, 100'000);
  const auto theirs = edgesOfS51(program);
  EXPECT_GT(ours.size(), 1000U);
  expectSameLevels(ours, theirs);
  EXPECT_THAT(delays(ours, theirs), Each(0));
}

// JNB has its bit's address in S4 of its first cycle. Intel does not say when the bit itself is read: here at
// the end of this cycle, in s51 in the second one. A wait for TF0 in passes of two cycles ends with the same
// pass, or with the next one; the timer goes on alike, so that the difference never adds up.
TEST_F(Mcs51Edges, OfAPolledTimerAreThoseOfS51OrOnePassOfTheLoopLater) {
  const Program program = manyWrites(true);
  const auto ours = edgesOfOurs(program, 100'000);
  const auto theirs = edgesOfS51(program);
  EXPECT_GT(ours.size(), 1000U);
  expectSameLevels(ours, theirs);
  const auto late = delays(ours, theirs);
  EXPECT_THAT(late, Each(AnyOf(0, 2)));
  EXPECT_THAT(late, Contains(0));
  EXPECT_THAT(late, Contains(2));
}

// A timer in mode 1 whose service reloads it, in a stream of NOPs. The overflow of cycle 0 is polled in 1;
// the call has 2 and 3, CPL 4, and MOV TL0,#156 writes in S6P2 of cycle 6. So cycle 7 counts first, and the
// hundredth count is that of cycle 106 (Intel 1994). In s51 the two cycles of the MOV count, after its write,
// and the call begins one cycle sooner: s51 polls a flag in the cycle that sets it.
TEST_F(Mcs51Edges, OfATimerReloadedWhileItRunsComeThreeCyclesLaterThanInS51) {
  Program p;
  p.ljmp(0x40).at(0x0B).cpl(kP1_0).mov(kTl0, 156).mov(kTh0, 255);
  p.djnzR(7, p.here() + 5).ljmp(0x300).reti();
  p.at(0x40).put({0x7F, 60}).mov(kTmod, 0x01).mov(kTl0, 156).mov(kTh0, 255).mov(kIe, 0x82).setb(kTr0);
  p.nop(0x2A0).at(0x300).halt();
  const auto ours = edgesOfOurs(p, 480);
  const auto theirs = edgesOfS51(p);
  ASSERT_GE(ours.size(), 4U);
  ASSERT_GE(theirs.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_EQ(ours[i].cycle - ours[i - 1].cycle, 106U);
    EXPECT_EQ(theirs[i].cycle - theirs[i - 1].cycle, 103U);
  }
}

}  // namespace
}  // namespace kerfbench::mcs51_child
