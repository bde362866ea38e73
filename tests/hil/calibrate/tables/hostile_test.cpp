// SPDX-License-Identifier: Apache-2.0
// Files that were cut off, damaged or made up: each is refused with a place, none breaks the program.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <sstream>

#include "hil/calibrate/tables/csv_table.h"
#include "hil/calibrate/tables/grid_text.h"
#include "hil/calibrate/tables/table_files.h"
#include "tests/hil/calibrate/tables/seeded_head.h"

namespace kerfbench::calibrate {
namespace {

struct Sample {
  const char* name;
  std::string bytes;
  std::function<AimGrid(const std::string&)> parse;
};

std::vector<Sample> samples() {
  const auto places = evenly(-50, 50, 7);
  const AimGrid grid = SeededHead(5, 50).table(places, places);
  CorConvention convention;
  convention.units_per_mm = 655.36;
  const auto cor = [](const std::string& bytes) { return parseCorFile(bytes, "f").grid; };
  return {
      {"csv", csvTable(grid), [](const std::string& b) { return parseCsvTable(b, "f"); }},
      {"grid text", gridText(grid), [](const std::string& b) { return parseGridText(b, "f"); }},
      {"nine points", ninePointText(grid), [](const std::string& b) { return parseNinePointText(b, "f"); }},
      {"C header", cHeader(grid), [](const std::string& b) { return parseCHeader(b, "f"); }},
      {"cor v1", corFile(grid, CorVersion::k1, convention), cor},
      {"cor v2", corFile(grid, CorVersion::k2, convention), cor}};
}

/// Expects a place that a user can look up: "f:12: …", "f: byte 36: …", or the file as a whole.
void expectPlaced(const std::string& faults, const std::string& what) {
  std::istringstream lines(faults);
  for (std::string line; std::getline(lines, line);)
    EXPECT_TRUE(line.starts_with("f:") && line.find_first_not_of("f:0123456789 ") != std::string::npos)
        << what << ": " << line;
}

/// Length of the shortest whole file: all but the last newline; of a C header, all up to the last array's
/// end, since no number follows; of a .cor v2, all but the four bytes that some have.
std::size_t wholeFrom(const std::string& bytes) {
  if (bytes.starts_with("JCZ")) return bytes.size() - 4;
  return bytes.ends_with("#endif\n") ? bytes.rfind('}') : bytes.size();
}

TEST(HostileFiles, CutOffAnywhere) {
  for (const Sample& sample : samples()) {
    const std::size_t step = std::max<std::size_t>(1, sample.bytes.size() / 300);
    std::size_t refused = 0, tried = 0;
    for (std::size_t length = 0; length < wholeFrom(sample.bytes); length += step, ++tried) {
      const std::string faults = faultsOf([&] { (void)sample.parse(sample.bytes.substr(0, length)); });
      refused += faults.empty() ? 0 : 1;
      expectPlaced(faults, sample.name);
    }
    EXPECT_EQ(refused, tried) << sample.name;
  }
}

TEST(HostileFiles, DamagedBytesAreRefusedOrGiveAGridOfFiniteNumbers) {
  const CounterRandom random(1, 2);
  std::uint64_t index = 0;
  for (const Sample& sample : samples()) {
    for (int round = 0; round < 400; ++round) {
      std::string bytes = sample.bytes;
      const auto hits = 1 + random.bits(index++) % 8;
      for (std::uint64_t hit = 0; hit < hits; ++hit)
        bytes[random.bits(index + 2 * hit) % bytes.size()] =
            static_cast<char>(random.bits(index + 2 * hit + 1));
      index += 2 * hits;
      expectPlaced(faultsOf([&] { (void)sample.parse(bytes); }), sample.name);
    }
  }
}

TEST(HostileFiles, NoiseIsNoTable) {
  const CounterRandom random(7, 3);
  std::uint64_t index = 0;
  for (const std::size_t size : {0U, 1U, 22U, 36U, 529U, 33836U, 68128U}) {
    std::string bytes(size, '\0');
    for (char& c : bytes) c = static_cast<char>(random.bits(index++));
    for (const Sample& sample : samples())
      EXPECT_NE(faultsOf([&] { (void)sample.parse(bytes); }), "") << sample.name << ", " << size;
    EXPECT_FALSE(formatOf(bytes));
  }
}

TEST(HostileFiles, CsvFaultsAreListedWithTheirLines) {
  EXPECT_EQ(
      faultsOf([] {
        (void)parseCsvTable("# c\nx_mm,y_mm,dx_mm,dy_mm\n0,0,0,nan\n1,0,0\n2,0,1e9,0\n3,zero,0,\n", "f");
      }),
      "f:3: 'nan' is no number\nf:4: a node has 4 numbers, this line has 3\nf:5: 1e+09 is beyond ±10000\n"
      "f:6: 'zero' is no number\nf:6: '' is no number");
  EXPECT_EQ(faultsOf([] { (void)parseCsvTable("x_mm,y_mm,dx_steps,dy_steps\n", "f"); }).substr(0, 28),
            "f:1: this table is of steps,");
  EXPECT_EQ(faultsOf([] { (void)parseCsvTable("x_mm,y_mm,dx_mm,dy_mm\n1,0,0,0\n0,0,0,0\n", "f"); }),
            "f:3: y must ascend, and x for each y: (0, 0) after (1, 0)");
  EXPECT_EQ(faultsOf([] { (void)parseCsvTable("", "f"); }), "f: there is no header x_mm,y_mm,dx_mm,dy_mm");
}

TEST(HostileFiles, IncompleteAndDoubledNodesAreNamed) {
  EXPECT_EQ(faultsOf([] { (void)parseGridText("0 0 0 0\n1 0 0 0\n0 1 0 0\n1 0 0 0\n", "f"); }),
            "f:4: the node (1, 0) was in line 2 already\nf: the grid lacks the node (1, 1)");
  EXPECT_EQ(faultsOf([] { (void)parseGridText("0 0 0 0\n1 0 0 0\n", "f"); }),
            "f: a grid has 2 x 2 to 1025 x 1025 nodes, this one 2 x 1");
  std::string line;
  for (int i = 0; i < 1100; ++i) line += std::to_string(i) + " 0 0 0\n" + std::to_string(i) + " 1 0 0\n";
  EXPECT_EQ(faultsOf([&] { (void)parseGridText(line, "f"); }),
            "f: a grid has 2 x 2 to 1025 x 1025 nodes, this one 1100 x 2");
}

TEST(HostileFiles, ControlCharactersAreNotShown) {
  EXPECT_EQ(faultsOf([] { (void)parseGridText("0 0 0 \x1b[31mred\n", "f"); }),
            "f:1: '?[31mred' is no number");
}

TEST(HostileFiles, ManyFaultsAreCounted) {
  std::string text;
  for (int i = 0; i < 50; ++i) text += "x\n";
  const std::string faults = faultsOf([&] { (void)parseGridText(text, "f"); });
  EXPECT_EQ(std::ranges::count(faults, '\n'), 20);
  EXPECT_TRUE(faults.ends_with("f: and 30 more"));
}

TEST(HostileFiles, CorFaultsAreListedWithTheirBytes) {
  const auto all = samples();
  std::string bytes = all[4].bytes;
  const auto put = [&](std::size_t at, double value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  put(0x170, 1.0);
  put(0x210, std::numeric_limits<double>::quiet_NaN());
  put(0x210 + 24, 40000.0);
  EXPECT_EQ(faultsOf([&] { (void)all[4].parse(bytes); }),
            "f: byte 368: the scale of 1 units/mm is out of 5 … 100000: a placeholder? Say how many units "
            "make 1 mm\n"
            "f: byte 528: nan units are beyond ±32767\nf: byte 552: 40000 units are beyond ±32767");
  EXPECT_EQ(faultsOf([&] { (void)all[5].parse(all[5].bytes + "more"); }),
            "f: byte 33836: the file has 33844 bytes, a JCZ_COR_2_1 has 33836");
  EXPECT_EQ(faultsOf([&] { (void)all[5].parse("JCZ_COR_3_0"); }),
            "f: byte 0: the label is neither LMC1COR_1.0 nor JCZ_COR_2_1");
}

TEST(HostileFiles, CHeaderFaultsAreListed) {
  std::string bytes = samples()[3].bytes;
  bytes.replace(bytes.find("_ROWS 7"), 7, "_ROWS 9");
  EXPECT_EQ(faultsOf([&] { (void)parseCHeader(bytes, "f"); }),
            "f: …_Y_NM has 7 numbers, not 9\nf: …_DX has 49 numbers, not 63\nf: …_DY has 49 numbers, not 63");
  EXPECT_NE(faultsOf([&] {
              (void)parseCHeader("static const int32_t A_X_NM[2] = {\n1, 99999999999\n", "f");
            }).find("f:2: a number is none, or beyond ±2147483647"),
            std::string::npos);
}

}  // namespace
}  // namespace kerfbench::calibrate
