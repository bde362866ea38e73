// SPDX-License-Identifier: Apache-2.0
// What a second reader answers is taken as it is defined or not at all, and held against our reading.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/witness/compare.h"
#include "hil/witness/second_reading.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::witness {
namespace {

using dieline::FileFormat;
using testing::ElementsAre;
using testing::HasSubstr;

std::string group(const std::string& names, const std::string& colour, const std::string& rest) {
  return R"({"names": )" + names + R"(, "colours": [")" + colour +
         R"("], "linetype": "Continuous", "plotted": true, )" + rest + "}";
}
std::string reading(const std::string& groups, const std::string& unread = "",
                    const std::string& remarks = "") {
  return R"({"reader": "test", "mm_per_unit": 1.0, "groups": [)" + groups + R"(], "unread": [)" + unread +
         R"(], "remarks": [)" + remarks + "]}";
}
const std::string kThirty = R"("count": 1, "length_mm": 30.0, "box_mm": [0, 0, 30, 0])";

Comparison compared(const std::string& drawing, const std::string& answer,
                    const dieline::DrawingOptions& options = {}) {
  const dieline::TempFile file(".dxf", drawing);
  return compareReadings(dieline::readDieline(file.path(), options), secondReadingFrom(answer), options,
                         FileFormat::kDxf);
}
std::string partings(const Comparison& comparison) {
  std::string text;
  for (const std::string& parting : comparison.partings) text += parting + "\n";
  return text;
}
const std::string kLine = dieline::dxf("0|LINE|8|CUT|10|0|20|0|11|30|21|0");

TEST(SecondReading, NamesAreBytes) {
  const SecondReading read =
      secondReadingFrom(reading(group(R"(["Schn%E4tt", "a%25b"])", "%23ff0000", kThirty)));
  ASSERT_EQ(read.lines.size(), 1U);
  EXPECT_THAT(read.lines[0].names, ElementsAre("Schn\xE4tt", "a%b"));
  EXPECT_THAT(read.lines[0].colours, ElementsAre("#ff0000"));
}

TEST(SecondReading, WhatIsNotDefinedIsRefused) {
  EXPECT_NO_THROW(secondReadingFrom(reading("")));
  for (
      const std::string& answer : {
          std::string("{}"),
          std::string("[]"),
          std::string("null"),
          std::string("1"),
          reading("") + "x",
          std::string(
              R"({"reader": "a", "reader": "b", "mm_per_unit": 1, "groups": [], "unread": [], "remarks": []})"),
          std::string(
              R"({"reader": "a", "mm_per_unit": 1, "groups": [], "unread": [], "remarks": [], "more": 1})"),
          std::string(R"({"reader": 1, "mm_per_unit": 1, "groups": [], "unread": [], "remarks": []})"),
          std::string(R"({"reader": "a", "mm_per_unit": null, "groups": [], "unread": [], "remarks": []})"),
          std::string(R"({"reader": "a", "mm_per_unit": 1, "groups": {}, "unread": [], "remarks": []})"),
          reading("1"),
          reading(group("[1]", "7", kThirty)),
          reading(group("[\"%zz\"]", "7", kThirty)),
          reading(group("[\"%4\"]", "7", kThirty)),
          reading("", "{}"),
          reading("", "", "1"),
          reading(group("[]", "7", R"("count": 0, "length_mm": 30.0, "box_mm": [0, 0, 30, 0])")),
          reading(group("[]", "7", R"("count": -1, "length_mm": 30.0, "box_mm": [0, 0, 30, 0])")),
          reading(group("[]", "7", R"("count": 1.5, "length_mm": 30.0, "box_mm": [0, 0, 30, 0])")),
          reading(group("[]", "7", R"("count": 1, "length_mm": 0, "box_mm": [0, 0, 30, 0])")),
          reading(group("[]", "7", R"("count": 1, "length_mm": 30.0, "box_mm": [0, 0, null, 0])")),
          std::string(R"({"missing": ""})"),
          std::string(R"({"missing": 1})"),
          std::string(R"({"refused": []})"),
      })
    EXPECT_THROW(secondReadingFrom(answer), NoReading) << answer;
}

TEST(CompareReadings, TheSameLinesAgree) {
  const Comparison comparison = compared(kLine, reading(group("[\"CUT\"]", "7", kThirty)));
  EXPECT_EQ(partings(comparison), "");
  EXPECT_EQ(comparison.layers, 1U);
  EXPECT_DOUBLE_EQ(comparison.length_mm, 30.0);
  // Names of layers have no case.
  EXPECT_EQ(partings(compared(kLine, reading(group("[\"Cut\"]", "7", kThirty)))), "");
}

TEST(CompareReadings, ALayerThatOnlyOneFindsIsNamed) {
  EXPECT_THAT(
      partings(compared(kLine, reading(""))),
      HasSubstr(
          "layer 'CUT' (cut): this reader finds 1 lines of 30.000000 mm there, the second one finds none"));
  const std::string more =
      reading(group("[\"CUT\"]", "7", kThirty) + "," + group("[\"CREASE\"]", "5", kThirty));
  EXPECT_THAT(partings(compared(kLine, more)),
              HasSubstr("layer 'CREASE' (crease): the second reader finds 1 lines"));
  // A layer for which there is no rule would have been refused, had ours found it.
  const std::string unknown =
      reading(group("[\"CUT\"]", "7", kThirty) + "," + group("[\"SECRET\"]", "5", kThirty));
  EXPECT_THAT(partings(compared(kLine, unknown)), HasSubstr("SECRET"));
  // What a rule ignores is not cut.
  const std::string ignored =
      reading(group("[\"CUT\"]", "7", kThirty) + "," + group("[\"NOTES\"]", "5", kThirty));
  EXPECT_EQ(partings(compared(kLine, ignored)), "");
}

TEST(CompareReadings, RulesByColourDecideForBothReaders) {
  const std::string drawing =
      dieline::dxf("0|LINE|8|A|62|1|10|0|20|0|11|30|21|0|0|LINE|8|A|62|5|10|0|20|9|11|30|21|9");
  dieline::DrawingOptions options;
  options.layers = {"test", {}};
  ASSERT_EQ(dieline::addLayerRule(options.layers, {"A", "color", "1"}, "cut"), "");
  ASSERT_EQ(dieline::addLayerRule(options.layers, {"A", "color", "5"}, "crease"), "");
  const std::string high = R"("count": 1, "length_mm": 30.0, "box_mm": [0, 9, 30, 9])";
  EXPECT_EQ(
      partings(compared(drawing, reading(group("[\"A\"]", "1", kThirty) + "," + group("[\"A\"]", "5", high)),
                        options)),
      "");
  // The colours the other way round: cut and crease have changed places.
  EXPECT_THAT(
      partings(compared(drawing, reading(group("[\"A\"]", "5", kThirty) + "," + group("[\"A\"]", "1", high)),
                        options)),
      HasSubstr("layer 'A' (cut): for this reader its lines reach over"));
}

/// Where ours sees one colour and the second reader two, ours would have asked for a rule.
TEST(CompareReadings, ColoursThatOursDidNotSeeAreTold) {
  const std::string half = R"("count": 1, "length_mm": 15.0, "box_mm": [0, 0, 15, 0])";
  const std::string other = R"("count": 1, "length_mm": 15.0, "box_mm": [15, 0, 30, 0])";
  EXPECT_THAT(partings(compared(
                  kLine, reading(group("[\"CUT\"]", "1", half) + "," + group("[\"CUT\"]", "5", other)))),
              HasSubstr("layer 'CUT' mixes lines that are drawn differently"));
}

TEST(CompareReadings, WhatIsNotFollowedIsTold) {
  const std::string groups = group("[\"CUT\"]", "7", kThirty);
  const std::string unread = group("[\"CUT\"]", "7", R"("count": 2, "what": "HELIX")");
  EXPECT_THAT(partings(compared(kLine, reading(groups, unread))), HasSubstr("does not follow 'HELIX'"));
  // On a layer that is not cut it may be anything.
  const std::string ignored = group("[\"NOTES\"]", "7", R"("count": 2, "what": "HELIX")");
  EXPECT_EQ(partings(compared(kLine, reading(groups, ignored))), "");
  // A remark explains a parting, and is none.
  EXPECT_EQ(partings(compared(kLine, reading(groups, "", "\"clip-path\""))), "");
  EXPECT_THAT(partings(compared(kLine, reading("", "", "\"clip-path\""))),
              HasSubstr("does not follow 'clip-path'"));
}

TEST(CompareReadings, TolerancesGrowAsRoundingDoes) {
  const Tolerance exact = toleranceFor(FileFormat::kDxf);
  EXPECT_DOUBLE_EQ(exact.lengthLimit_mm(0, 1, 1000), 1e-3);
  EXPECT_DOUBLE_EQ(exact.lengthLimit_mm(1e6, 1'000'000, 1000), 2e-3);
  // A thousand lines over 200 mm, whose ends are rounded to 24 bits.
  const Tolerance single = toleranceFor(FileFormat::kPdf);
  EXPECT_GT(single.lengthLimit_mm(1000, 1000, 200), 1e-3);
  EXPECT_LT(single.lengthLimit_mm(1000, 1000, 200), 3e-3);
}

/// A drawing of which part is selected is witnessed as a whole.
TEST(CompareReadings, WhatIsNotSelectedCounts) {
  const dieline::TempFile file(".dxf", kLine);
  dieline::Dieline read = dieline::readDieline(file.path(), dieline::DrawingOptions{});
  read.entities[0].left_out = read.entities[0].process;
  read.entities[0].process = dieline::Process::kIgnore;
  const SecondReading second = secondReadingFrom(reading(group("[\"CUT\"]", "7", kThirty)));
  EXPECT_EQ(partings(compareReadings(read, second, {}, FileFormat::kDxf)), "");
}

}  // namespace
}  // namespace kerfbench::witness
