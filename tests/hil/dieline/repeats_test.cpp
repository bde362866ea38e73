// SPDX-License-Identifier: Apache-2.0
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string svg(const std::string& inside) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"80mm\" viewBox=\"0 0 100 80\">" +
         inside + "</svg>";
}
Dieline once(const std::string& text) {
  DrawingOptions options;
  options.once = true;
  return readText(".svg", text, options);
}
double lengthOfAll(const Dieline& dieline) {
  double length_mm = 0.0;
  for (const Entity& entity : dieline.entities) length_mm += lengthOf(entity.curve);
  return length_mm;
}
std::vector<LintFinding::Kind> errorsOf(const Dieline& dieline) {
  std::vector<LintFinding::Kind> kinds;
  for (const LintFinding& finding : lintDieline(dieline))
    if (finding.is_error) kinds.push_back(finding.kind);
  return kinds;
}

/// One path round a sheet, with a slit and a mark for folding that are drawn forth and back, as programs do
/// that draw without lifting the pen. The fold mark goes back farther than it came.
const std::string kSlits =
    svg("<path fill='none' stroke='#000000' d='M10 10 H50 V20 H35 H50 V60 V52 V60 H10 V30 H4 H10 V10'/>");

TEST(Repeats, SlitsDrawnForthAndBackAreCutOnce) {
  const Dieline twice = readText(".svg", kSlits);
  EXPECT_THAT(errorsOf(twice), testing::Not(IsEmpty()));
  const Dieline dieline = once(kSlits);
  EXPECT_THAT(errorsOf(dieline), IsEmpty());
  EXPECT_NEAR(lengthOfAll(dieline), 40 + 50 + 40 + 50 + 15 + 6, 1e-9);
  EXPECT_THAT(dieline.notes, ElementsAre(HasSubstr("repeated lines: 4 of 37.000 mm left out")));
  for (std::size_t i = 0; i < dieline.entities.size(); ++i)
    EXPECT_EQ(dieline.entities[i].id, static_cast<int>(i));
}

TEST(Repeats, OneThatIsPartOfALongerGoesWhicheverComesFirst) {
  const std::string part = "<path fill='none' stroke='#ff0000' d='M20 10 H30'/>";
  const std::string whole = "<path fill='none' stroke='#ff0000' d='M10 10 H50'/>";
  for (const std::string& text : {svg(part + whole), svg(whole + part)}) {
    const Dieline dieline = once(text);
    ASSERT_EQ(dieline.entities.size(), 1U);
    EXPECT_NEAR(lengthOfAll(dieline), 40, 1e-9);
  }
}

TEST(Repeats, WhatIsNoRepeatStays) {
  const std::string line = "<path fill='none' stroke='#ff0000' d='M10 10 H50'/>";
  for (const char* other : {"<path fill='none' stroke='#0000ff' d='M10 10 H50'/>",     // a crease on the cut
                            "<path fill='none' stroke='#ff0000' d='M40 10 H60'/>",     // lies on it in part
                            "<path fill='none' stroke='#ff0000' d='M10 10.02 H50'/>",  // beside it
                            "<path fill='none' stroke='#ff0000' d='M10 10 L50 10.02'/>"}) {
    const Dieline dieline = once(svg(line + other));
    EXPECT_EQ(dieline.entities.size(), 2U) << other;
    EXPECT_THAT(dieline.notes, IsEmpty()) << other;
  }
}

TEST(Repeats, ArcsAndCurvesToo) {
  const std::string disc = "<circle fill='none' stroke='#ff0000' cx='40' cy='40' r='20'/>";
  const std::string again = "<path fill='none' stroke='#ff0000' d='M60 40 A20 20 0 0 1 20 40'/>";
  const std::string bow = "<path fill='none' stroke='#ff0000' d='M5 5 C20 5 20 60 70 70'/>";
  const std::string back = "<path fill='none' stroke='#ff0000' d='M70 70 C20 60 20 5 5 5'/>";
  const Dieline dieline = once(svg(again + disc + bow + back));
  EXPECT_EQ(dieline.entities.size(), 2U);
  EXPECT_NEAR(lengthOf(dieline.entities.front().curve), 40 * std::numbers::pi, 1e-9);
}

TEST(Repeats, AHeapOfCopiesIsOneLine) {
  std::string lines;
  for (int i = 0; i < 3000; ++i) lines += "<path fill='none' stroke='#ff0000' d='M10 10 H50'/>";
  EXPECT_EQ(once(svg(lines)).entities.size(), 1U);
}

TEST(Repeats, LintSaysHowToCutOnce) {
  const auto advice = [](const Dieline& dieline) {
    return adviceOnRepeats(lintDieline(dieline, kAllFindings));
  };
  EXPECT_THAT(advice(readText(".svg", kSlits)).value_or(""), HasSubstr("once: true"));
  EXPECT_FALSE(advice(once(kSlits)).has_value());
}

}  // namespace
}  // namespace kerfbench::dieline
