// SPDX-License-Identifier: Apache-2.0
// Drawings that are made to take all time or memory: one sentence, within 1 s of a processor and 256 MiB.
// A large one may take twice as long for each byte as a sound drawing takes on this computer, as loaded as it
// is. Each is read by a process of its own, which is measured.
#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/dieline/files.h"
#include "tests/hil/dieline/pdf_writer.h"
#include "tests/hil/dieline/reading_child.h"

namespace kerfbench::dieline {
namespace {

std::string times(std::size_t count, const std::string& part) {
  std::string text;
  text.reserve(count * part.size());
  for (std::size_t i = 0; i < count; ++i) text += part;
  return text;
}

const std::string kDxfHead = "0\nSECTION\n2\nENTITIES\n";
const std::string kDxfTail = "0\nENDSEC\n0\nEOF\n";

struct HostileDrawing {
  std::string name;
  std::string extension;
  std::string text;
  std::string sentence;
  double most_mib{256};
};

/// Seconds of a processor that a sound drawing takes for each byte.
double soundRate() {
  static const double kRate = [] {
    const std::string text =
        kDxfHead + times(200'000, "0\nLINE\n8\nCUT\n10\n0\n20\n0\n11\n1\n21\n2\n") + kDxfTail;
    const TempFile file(".dxf", text);
    const ReadingChild child = readInChild(file.path());
    EXPECT_EQ(child.exit_code, 0) << child.said.substr(0, 500);
    return child.cpu_s / static_cast<double>(text.size());
  }();
  return kRate;
}

void expectAllRefused(const std::vector<HostileDrawing>& drawings) {
  if (childIsWatched()) std::puts("a sanitizer's own memory and time count: neither is limited here");
  for (const HostileDrawing& drawing : drawings) {
    const TempFile file(drawing.extension, drawing.text);
    const double most_s = std::max(1.0, 2.0 * soundRate() * static_cast<double>(drawing.text.size()));
    expectRefusedInTime(file.path(), drawing.name, drawing.sentence, drawing.most_mib, most_s);
  }
}

/// Each block holds the next one `copies` times; the last holds a line.
std::string blocksInBlocks(int depth, std::size_t copies) {
  std::string blocks = "0|BLOCK|2|B0|0|LINE|8|CUT|10|0|20|0|11|1|21|1|0|ENDBLK";
  for (int i = 1; i <= depth; ++i) {
    blocks += "|0|BLOCK|2|B" + std::to_string(i) +
              times(copies, "|0|INSERT|8|CUT|2|B" + std::to_string(i - 1) + "|10|0|20|0") + "|0|ENDBLK";
  }
  return dxf("0|INSERT|8|CUT|2|B" + std::to_string(depth) + "|10|0|20|0", "", blocks);
}

TEST(HostileLimits, Dxf) {
  expectAllRefused({
      {"10^4 inserts in each other", ".dxf", blocksInBlocks(10'000, 1), "nested deeper than 16"},
      {"doubling", ".dxf", blocksInBlocks(14, 4), "more than 1000000 entities"},
      {"doubling, deep", ".dxf", blocksInBlocks(60, 2), "nested deeper than 16"},
      {"a block that holds itself", ".dxf",
       dxf("0|INSERT|8|CUT|2|A|10|0|20|0", "", "0|BLOCK|2|A|0|INSERT|8|CUT|2|A|10|0|20|0|0|ENDBLK"),
       "nested deeper than 16"},
      {"1e308", ".dxf", dxf("0|LINE|8|CUT|10|1e308|20|0|11|1|21|2"), "out of range: '1e308'"},
      {"NaN", ".dxf", dxf("0|LINE|8|CUT|10|nan|20|0|11|1|21|2"), "no number: 'nan'"},
      {"a group of 32 MB", ".dxf", dxf("0|LINE|8|CUT|10|" + std::string(32'000'000, '9') + "|20|0|11|1|21|2"),
       "is no number"},
      {"10^6 lines on a layer without a rule", ".dxf",
       kDxfHead + times(1'000'000, "0\nLINE\n8\nQ\n10\n0\n20\n0\n11\n1\n21\n2\n") + kDxfTail,
       "on layer 'Q' (and 999999 more on this layer), for which", 500},
      {"blank groups", ".dxf", kDxfHead + times(8'000'000, "1\n\n"), "without EOF"},
  });
}

TEST(HostileLimits, Svg) {
  std::string uses = "<defs><g id='u0'><path d='M0 0h1' stroke='red'/></g>";
  for (int i = 1; i <= 30; ++i) {
    const std::string use = "<use href='#u" + std::to_string(i - 1) + "'/>";
    uses += "<g id='u" + std::to_string(i) + "'>" + use + use + "</g>";
  }
  uses += "</defs><use href='#u";
  std::string laughs = "<!DOCTYPE svg [<!ENTITY l0 '1 1'>";
  for (int i = 1; i <= 9; ++i) {
    laughs += "<!ENTITY l" + std::to_string(i) + " '" + times(10, "&l" + std::to_string(i - 1) + ";") + "'>";
  }
  laughs += "]>";
  const std::string much = times(1'000'000, "<rect/>");
  expectAllRefused({
      {"doubling uses", ".svg", svg(uses + "14'/>" + times(200, "<use href='#u14'/>")),
       "more than 2000000 elements"},
      {"uses in each other", ".svg", svg(uses + "30'/>"), "nested deeper than 16"},
      {"a use of itself", ".svg", svg("<use id='a' href='#a'/>"), "nested deeper than 16"},
      {"10^5 groups in each other", ".svg", svg(times(100'000, "<g>") + times(100'000, "</g>")),
       "nested deeper than 256"},
      {"an entity of a file", ".svg",
       "<!DOCTYPE svg [<!ENTITY x SYSTEM 'file:///etc/passwd'>]>" + svg("<path stroke='red' d='&x;'/>"),
       "path data is broken"},
      {"a billion laughs", ".svg", laughs + svg("<path stroke='red' d='M 0 0 L &l9;'/>"),
       "path data is broken"},
      {"1e308", ".svg", svg("<line stroke='red' x2='1e308'/>"), "1e308"},
      {"NaN", ".svg", svg("<line stroke='red' x2='nan'/>"), "nan"},
      {"scales beyond all numbers", ".svg",
       svg("<path stroke='red' d='M0 0C1e9 1 -1e9 2 3 3' transform='" + times(34, "scale(1e9,1e-9)") + "'/>"),
       "wrong units or scale?"},
      {"an attribute of 64 MB", ".svg", svg("<path stroke='red' d='" + std::string(64'000'000, '-') + "'/>"),
       "path data is broken"},
      {"3 million elements", ".svg", svg(times(3'000'000, "<g/>")), "more than 2000000 elements"},
      {"11 million attributes", ".svg", svg("<g " + times(11'000'000, "a='' ") + "/>"),
       "more than 10000000 attributes"},
      {"2000 uses of what has 1001 attributes", ".svg",
       svg("<defs><g id='a' " + times(1001, "x='1' ") + "/></defs>" + times(2000, "<use href='#a'/>")),
       "an element of more than 1000 attributes"},
      {"10^6 elements that are none", ".svg", svg(times(1'000'000, "<q/>") + "<q"), "is not well-formed"},
  });
}

TEST(HostileLimits, Cf2) {
  std::string subs;
  for (int i = 1; i <= 40; ++i) {
    subs += "SUB,S" + std::to_string(i) + "\n" + times(2, "C,S" + std::to_string(i - 1) + ",0,0,0,1,1\n") +
            "END\n";
  }
  const std::string head = "$BOF\nV2\nORDER\nEND\nMAIN,A\nUM\n";
  const std::string tail = "END\n$EOF\n";
  expectAllRefused({
      {"doubling", ".cf2",
       head + "C,S40,0,0,0,1,1\n" + "END\nSUB,S0\nL,2,1,0,0,0,1,1,0,0\nEND\n" + subs + "$EOF\n", "S"},
      {"a SUB that places itself", ".cf2", head + "C,S,0,0,0,1,1\nEND\nSUB,S\nC,S,0,0,0,1,1\n" + tail, "S"},
      {"1e308", ".cf2", head + "L,2,1,0,1e308,0,1,1,0,0\n" + tail, "1e308"},
      {"10^6 lines of an unknown type", ".cf2", head + times(1'000'001, "L,2,77,0,0,0,1,1,0,0\n") + tail,
       "more than 1000000 records"},
      {"a record of 64 MB", ".cf2", head + "L,2,1,0," + std::string(64'000'000, '9') + ",0,1,1,0,0\n" + tail,
       "no number of a drawing"},
  });
}

}  // namespace
}  // namespace kerfbench::dieline
