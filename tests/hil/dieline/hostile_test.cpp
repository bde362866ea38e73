// SPDX-License-Identifier: Apache-2.0
// Files that are broken by accident or on purpose: refused with a reason, quickly, never by a crash.
#include <fstream>
#include <random>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/read.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string contents(const std::string& name) {
  std::ostringstream text;
  text << std::ifstream(fixture(name), std::ios::binary).rdbuf();
  return text.str();
}

TEST(HostileDxf, IsToldWhereItBreaks) {
  EXPECT_THAT(faultsOf(".dxf", "0\nSECTION\n2\nENTITIES\nhello\nworld\n"),
              HasSubstr(":5: expected a group code, found 'hello'"));
  EXPECT_THAT(faultsOf(".dxf", "root:x:0:0\n"),
              HasSubstr(":1: expected a group code: this is no DXF drawing"));
  EXPECT_THAT(faultsOf(".dxf", "root:x:0:0\n"), Not(HasSubstr("root")));
  EXPECT_THAT(faultsOf(".dxf", "0\nSECTION\n2\nENTITIES\n0"), HasSubstr(":5: the file ends inside a group"));
  EXPECT_THAT(faultsOf(".dxf", "0\nSECTION\n2\nENTITIES\n0\nENDSEC\n"), HasSubstr("without EOF"));
  EXPECT_THAT(faultsOf(".dxf", "0\nSECTION\n2\nENTITIES\n0\nEOF\n"), HasSubstr("no ENDSEC"));
  EXPECT_THAT(faultsOf(".dxf", "0\nEOF\n"), HasSubstr("no ENTITIES section"));
  EXPECT_THAT(faultsOf(".dxf", std::string("AutoCAD Binary DXF\r\n\x1a\0", 22)), HasSubstr("binary DXF"));
  EXPECT_THAT(faultsOf(".dxf", std::string(1000, '\0')), HasSubstr("expected a group code"));
  EXPECT_THAT(faultsOf(".dxf", ""), HasSubstr("is empty"));
}

TEST(HostileDxf, ListsAllFaultsAtOnce) {
  const std::string faults =
      faultsOf(".dxf", dxf("0|LINE|8|CUT|10|nan|20|0|11|1|21|2|0|CIRCLE|8|CUT|10|0|20|0|40|-3|"
                           "0|CIRCLE|8|CUT|10|1e300|20|0|40|1|0|ARC|8|CUT|10|0|20|0|40|1|50|0|"
                           "0|LWPOLYLINE|8|CUT|90|9|10|0|20|0|10|1|20|1"));
  EXPECT_THAT(faults, HasSubstr("group 10 is no number: 'nan'"));
  EXPECT_THAT(faults, HasSubstr("CIRCLE has radius -3"));
  EXPECT_THAT(faults, HasSubstr("group 10 is out of range: '1e300'"));
  EXPECT_THAT(faults, HasSubstr("ARC lacks group 51"));
  EXPECT_THAT(faults, HasSubstr("announces 9 vertices and has 2"));
}

TEST(HostileDxf, BlocksThatHoldThemselvesEnd) {
  EXPECT_THAT(faultsOf(".dxf", dxf("0|INSERT|8|CUT|2|A|10|0|20|0", "",
                                   "0|BLOCK|2|A|10|0|20|0|0|INSERT|8|CUT|2|B|10|0|20|0|0|ENDBLK|"
                                   "0|BLOCK|2|B|10|0|20|0|0|INSERT|8|CUT|2|A|10|0|20|0|0|ENDBLK")),
              HasSubstr("nested deeper than 16"));
}

TEST(HostileDxf, BlocksThatUnfoldWithoutBoundEnd) {
  // The file has ten blocks of ten copies each of the next, the last one empty: 10^10 copies of nothing.
  std::string blocks = "0|BLOCK|2|B0|0|ENDBLK";
  for (int i = 1; i <= 10; ++i) {
    const std::string inner = "B" + std::to_string(i - 1);
    blocks += "|0|BLOCK|2|B" + std::to_string(i) + "|0|INSERT|8|CUT|2|" + inner + "|10|0|20|0|70|10|0|ENDBLK";
  }
  EXPECT_THAT(faultsOf(".dxf", dxf("0|INSERT|8|CUT|2|B10|10|0|20|0", "", blocks)),
              HasSubstr("more than 1000000 entities"));
  EXPECT_THAT(faultsOf(".dxf", dxf("0|INSERT|8|CUT|2|B0|10|0|20|0|70|2000000000|71|2000000000", "", blocks)),
              HasSubstr("more than 1000000 entities"));
}

TEST(HostileDxf, ScalesThatLeaveTheSheetAreRefused) {
  std::string blocks = "0|BLOCK|2|B0|0|LINE|8|CUT|10|0|20|0|11|1|21|1|0|ENDBLK";
  for (int i = 1; i <= 12; ++i) {
    blocks += "|0|BLOCK|2|B" + std::to_string(i) + "|0|INSERT|8|CUT|2|B" + std::to_string(i - 1) +
              "|10|1|20|1|41|1e9|42|1e9|43|1|0|ENDBLK";
  }
  EXPECT_THAT(faultsOf(".dxf", dxf("0|INSERT|8|CUT|2|B12|10|0|20|0", "", blocks)),
              HasSubstr("wrong units or scale?"));
}

TEST(HostileSvg, IsToldWhereItBreaks) {
  const auto faults = [](const std::string& body) { return faultsOf(".svg", svg(body)); };
  EXPECT_THAT(faultsOf(".svg", "<svg>\n<g>\n</svg>"), HasSubstr(":3: is not well-formed XML"));
  EXPECT_THAT(faultsOf(".svg", "<html/>"), HasSubstr("outermost element is not svg"));
  EXPECT_THAT(faultsOf(".svg", std::string("\x7f\x45LF\0\0", 6)), HasSubstr("not well-formed"));
  EXPECT_THAT(faultsOf(".svg", "<svg xmlns='http://www.w3.org/2000/svg' width='9mm'/>"),
              HasSubstr("where is its bottom"));
  EXPECT_THAT(faults("<path stroke='red' d='M 0 0 L 1 x'/>"),
              HasSubstr("path data is broken at character 11"));
  EXPECT_THAT(faults("<path stroke='red' d='L 1 1'/>"), HasSubstr("path data is broken"));
  EXPECT_THAT(faults("<path stroke='red' d='M 0 0 L nan 1'/>"), HasSubstr("path data is broken"));
  EXPECT_THAT(faults("<path stroke='red' d='M 0 0 L 1e999 1'/>"), HasSubstr("path data is broken"));
  EXPECT_THAT(faults("<path stroke='red' d='M 0 0 A 1 1 0 2 0 5 5'/>"), HasSubstr("path data is broken"));
  EXPECT_THAT(faults("<path stroke='red' d='M 0 0 L 1 1 z 5'/>"), HasSubstr("path data is broken"));
  EXPECT_THAT(faults("<polygon stroke='red' points='0 0 1'/>"), HasSubstr("points are broken"));
  EXPECT_THAT(faults("<circle stroke='red' r='-1'/>"), HasSubstr("negative radius"));
  EXPECT_THAT(faults("<g transform='rotate(1,2)'/>"), HasSubstr("transform is broken"));
  EXPECT_THAT(faults("<g transform=')('/>"), HasSubstr("transform is broken"));
  EXPECT_THAT(faults("<line stroke='red' x2='1' transform='scale(0)'/>"), HasSubstr("flattened to nothing"));
  EXPECT_THAT(faultsOf(".svg", svg("", "width='10mm' height='10mm' viewBox='0 0 0 5'")),
              HasSubstr("do not fit"));
}

TEST(HostileSvg, UsesThatHoldThemselvesEnd) {
  EXPECT_THAT(faultsOf(".svg", svg("<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>")),
              HasSubstr("nested deeper"));
  EXPECT_THAT(faultsOf(".svg", svg("<g id='a'><use href='#a'/></g>")), HasSubstr("nested deeper"));
}

TEST(HostileSvg, UsesThatUnfoldWithoutBoundEnd) {
  std::string body = "<defs><g id='u0'/>";
  for (int i = 1; i <= 12; ++i) {
    body += "<g id='u" + std::to_string(i) + "'>";
    for (int k = 0; k < 10; ++k) body += "<use href='#u" + std::to_string(i - 1) + "'/>";
    body += "</g>";
  }
  EXPECT_THAT(faultsOf(".svg", svg(body + "</defs><use href='#u12'/>")),
              HasSubstr("more than 2000000 elements"));
}

TEST(HostileSvg, DeepNestingEnds) {
  std::string body;
  for (int i = 0; i < 100000; ++i) body += "<g>";
  for (int i = 0; i < 100000; ++i) body += "</g>";
  EXPECT_THAT(faultsOf(".svg", svg(body)), HasSubstr("nested deeper than 256"));
}

TEST(HostileDxf, TenThousandBlocksInEachOtherEnd) {
  std::string blocks = "0|BLOCK|2|B0|0|LINE|8|CUT|10|0|20|0|11|1|21|1|0|ENDBLK";
  for (int i = 1; i <= 10000; ++i) {
    blocks += "|0|BLOCK|2|B" + std::to_string(i) + "|0|INSERT|8|CUT|2|B" + std::to_string(i - 1) +
              "|10|0|20|0|0|ENDBLK";
  }
  EXPECT_THAT(faultsOf(".dxf", dxf("0|INSERT|8|CUT|2|B10000|10|0|20|0", "", blocks)),
              HasSubstr("nested deeper than 16"));
  // Blocks that are looked at first from near their bottom are no less deep.
  EXPECT_THAT(
      faultsOf(".dxf", dxf("0|INSERT|8|CUT|2|B9|10|0|20|0|0|INSERT|8|CUT|2|B20|10|0|20|0", "", blocks)),
      HasSubstr("nested deeper than 16"));
  EXPECT_EQ(faultsOf(".dxf", dxf("0|INSERT|8|CUT|2|B9|10|0|20|0|0|INSERT|8|CUT|2|B12|10|0|20|0", "", blocks)),
            "");
}

TEST(HostileSvg, EntitiesAndFilesOfTheDoctypeAreNotTaken) {
  // Neither a file of this computer nor a text that grows a thousandfold at each step gets into the drawing.
  const std::string head =
      "<?xml version='1.0'?><!DOCTYPE svg [<!ENTITY secret SYSTEM 'file:///etc/passwd'>"
      "<!ENTITY a '0 1 2 3 4 5 6 7 8 9'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;'>"
      "<!ENTITY c '&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;'>]>";
  EXPECT_THAT(faultsOf(".svg", head + svg("<path stroke='red' d='M0 0L&c;'/>")),
              HasSubstr("path data is broken"));
  const std::string faults = faultsOf(".svg", head + svg("<path stroke='red' d='&secret;'/>"));
  EXPECT_THAT(faults, HasSubstr("path data is broken"));
  EXPECT_THAT(faults, testing::Not(HasSubstr("root:")));
}

TEST(HostileSvg, SelectorsOverADeepTreeTakeTheirTimeOnly) {
  // Twelve ancestors among two hundred: 10^18 ways to choose them, and none is right.
  std::string selector;
  for (int i = 0; i < 12; ++i) selector += "g ";
  std::string body = "<style>rect " + selector + "line{stroke:red}</style>";
  for (int i = 0; i < 200; ++i) body += "<g>";
  body += "<line x2='9' stroke='blue'/>";
  for (int i = 0; i < 200; ++i) body += "</g>";
  EXPECT_EQ(readText(".svg", svg(body)).entities.at(0).layer, "#0000ff");
}

TEST(HostileSvg, RulesTimesClassesEnd) {
  // Nine thousand classes of one element, and as many rules: each rule would look through all of them.
  std::string rules;
  std::string classes;
  for (int i = 0; i < 9000; ++i) {
    const std::string name = "c" + std::to_string(i);
    rules += "." + name + "{stroke:red}";
    classes += name + " ";
  }
  EXPECT_THAT(faultsOf(".svg", svg("<style>" + rules + "</style><line x2='9' class='" + classes + "'/>")),
              HasSubstr("more than 200000000 comparisons of classes"));
}

TEST(Hostile, OtherFilesAreRefused) {
  EXPECT_THAT(faultsOf(".eps", "%!PS"),
              HasSubstr("extension '.eps' is not supported; .dxf, .svg, .pdf and .cf2 are"));
  EXPECT_THROW(readDieline("no/such/file.dxf", defaultLayerProfile()), DielineError);
  EXPECT_THROW(readDieline(std::filesystem::temp_directory_path() / ".", defaultLayerProfile()),
               DielineError);
}

/// Cuts, changes and doubles lines of sound files; each must be read or refused with its path. Time that has
/// no bound ends by the limit of the test.
TEST(Hostile, MutatedFilesAreReadOrRefused) {
  std::mt19937 random(3);
  const auto upTo = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  const std::vector<std::string> junk{"-1", "99999999", "1e308", "nan", "",     "0",
                                      "70", "10",       "'",     "<",   "\xff", std::string(5000, 'x')};
  int refused = 0;
  for (const std::string name : {"reader/entities-R2000.dxf", "label-60x40.svg", "label-60x40-paths.svg"}) {
    const std::string extension = std::filesystem::path(name).extension();
    const std::string whole = contents(name);
    ASSERT_FALSE(whole.empty());
    for (int i = 0; i < 400; ++i) {
      std::string text = whole;
      for (std::size_t n = upTo(4) + 1; n > 0; --n) {
        // The second half of a DXF holds its entities.
        const std::size_t at = text.size() / 2 + upTo(text.size() / 2 + 1);
        const std::size_t start = text.rfind('\n', at) + 1;
        const std::size_t end = std::min(text.find('\n', at), text.size());
        switch (upTo(4)) {
          case 0:
            text.erase(std::min(start, end), end - std::min(start, end));
            break;
          case 1:
            text.replace(std::min(start, end), end - std::min(start, end), junk[upTo(junk.size())]);
            break;
          case 2:
            text.insert(at, junk[upTo(junk.size())]);
            break;
          default:
            text.resize(upTo(5) == 0 ? at : text.size());
        }
        if (text.size() < 10) break;
      }
      const std::string faults = faultsOf(extension, text);
      refused += faults.empty() ? 0 : 1;
      if (!faults.empty()) {
        EXPECT_THAT(faults, HasSubstr("kerfbench-dieline-"));
      }
    }
  }
  EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace kerfbench::dieline
