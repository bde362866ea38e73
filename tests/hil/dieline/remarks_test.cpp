// SPDX-License-Identifier: Apache-2.0
#include "hil/dieline/remarks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using testing::AllOf;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

/// A rectangle of 60 x 40 units with a word in it.
const char* const kBody =
    "<rect x='10' y='5' width='60' height='40' fill='none' stroke='black'/>\n<text>6 x 4</text>";

std::vector<Remark> remarksIn(const std::string& attributes, std::optional<DrawingUnit> unit) {
  DrawingOptions options;
  options.unit = unit;
  return remarksOf(readText(".svg", svg(kBody, attributes), options));
}

TEST(Remarks, AnSvgThatDoesNotSayItsUnitIsToldWithTheSizeThatItGets) {
  const char* kBare = "width='100' height='50'";
  const auto mm = remarksIn(kBare, DrawingUnit::kMillimetre);
  ASSERT_EQ(mm.size(), 2U);
  EXPECT_EQ(mm[0].line, 1);
  EXPECT_TRUE(mm[0].is_warning);
  EXPECT_EQ(mm[0].message,
            "the file does not say how long one unit is; it is taken as 1 mm, which makes the drawing 60.0 x "
            "40.0 mm");
  EXPECT_THAT(remarksIn(kBare, DrawingUnit::kInch)[0].message,
              AllOf(HasSubstr("1 in (25.4 mm)"), HasSubstr("1524.0 x 1016.0 mm")));
  EXPECT_THAT(remarksIn(kBare, DrawingUnit::kPixel)[0].message, HasSubstr("1 px (0.2646 mm)"));
}

TEST(Remarks, TextThatIsLeftOutIsAWarningAtItsLine) {
  const auto remarks = remarksIn("width='100mm' height='50mm' viewBox='0 0 100 50'", std::nullopt);
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_EQ(remarks[0].line, 3);
  EXPECT_TRUE(remarks[0].is_warning);
  EXPECT_EQ(remarks[0].message, "text: 1 ignored: no line to cut");
}

TEST(Remarks, WhatSaysItsUnitIsNotAskedForIt) {
  EXPECT_FALSE(readText(".svg", svg(kBody)).unsaid_unit);
  EXPECT_FALSE(readText(".svg", svg(kBody, "width='100' height='50' inkscape:version='1.2'")).unsaid_unit);
  const std::string line = "0|LINE|8|CUT|10|0|20|0|11|10|21|0";
  EXPECT_FALSE(readText(".dxf", dxf(line, "9|$INSUNITS|70|4")).unsaid_unit);
  EXPECT_FALSE(readText(".dxf", dxf(line, "9|$MEASUREMENT|70|0")).unsaid_unit) << "inches, in R12";
  const auto none = readText(".dxf", dxf(line, "9|$INSUNITS|70|0"));
  ASSERT_TRUE(none.unsaid_unit);
  EXPECT_EQ(none.unsaid_unit->line, 8);
  EXPECT_EQ(none.unsaid_unit->taken_mm, 1.0);
  EXPECT_EQ(readText(".dxf", dxf(line)).unsaid_unit->line, 0);
}

TEST(Remarks, NotesWithoutAPlaceAreNoWarnings) {
  Dieline drawing;
  drawing.notes = {"Ignored by its rule: layer 'MASSE', 3 lines.", "text: 2 (the first at line x)"};
  EXPECT_THAT(remarksOf(drawing),
              testing::Each(AllOf(Field(&Remark::line, 0), Field(&Remark::is_warning, false))));
  EXPECT_THAT(remarksOf({}), IsEmpty());
}

TEST(Remarks, UnitsHaveTheirNames) {
  for (const char* name : {"mm", "cm", "in", "pt", "px"})
    EXPECT_EQ(nameOfUnit(millimetresOf(*drawingUnitFromName(name))), name);
  EXPECT_EQ(nameOfUnit(1000.0), "");
}

}  // namespace
}  // namespace kerfbench::dieline
