// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/read.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

/// A CF2 file of one block, and others behind it.
std::string cf2(const std::string& main, const std::string& subs = "", const std::string& unit = "UM\n") {
  return "$BOF\nV2\nORDER\n%1:CUSTOMER, INC\nEND\nMAIN,DESIGN\n" + unit +
         "LL,-500,-500\nUR,500,500\nSCALE,1,1\n" + main + "END\n" + subs + "$EOF\n";
}
Dieline readCf2Text(const std::string& main, const std::string& subs = "") {
  return readText(".cf2", cf2(main, subs));
}
std::string cf2Faults(const std::string& main, const std::string& subs = "",
                      const std::string& unit = "UM\n") {
  return faultsOf(".cf2", cf2(main, subs, unit));
}

TEST(Cf2, ReadsLinesWithTheProcessOfTheirType) {
  const Dieline dieline = readCf2Text(
      "L,2,1,0,0,0,10,5,0,0\nL,3,2,0,1,1,2,2,0,0\nL,2,3,7,0,1,0,2,0,0\nL,2,4,0,5,5,6,6\nL,2,46,0,9,9,8,8,0,"
      "0\n");
  ASSERT_EQ(dieline.entities.size(), 5U);
  const std::vector<Process> processes{Process::kCut, Process::kCrease, Process::kPerforation,
                                       Process::kHalfCut, Process::kIgnore};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(dieline.entities[i].process, processes[i]) << i;
  EXPECT_EQ(dieline.entities[0].layer, "CF2 type 1");
  EXPECT_EQ(dieline.entities[0].origin, "line 11: L of 2 pt");
  EXPECT_EQ(pointAt(dieline.entities[0].curve, 1), Vector2d(10, 5));
  EXPECT_THAT(dieline.notes, Contains(HasSubstr("layer 'CF2 type 46', 1 lines")));
}

TEST(Cf2, RulesOfLayersNameTypes) {
  const LayerProfile profile{"own", {{"CF2 type 42", Process::kCrease}, {"cf2 TYPE 1", Process::kHalfCut}}};
  const Dieline dieline = readText(".cf2", cf2("L,2,42,0,0,0,10,5,0,0\nL,2,1,0,0,0,1,5,0,0\n"), profile);
  EXPECT_EQ(dieline.entities[0].process, Process::kCrease);
  EXPECT_EQ(dieline.entities[1].process, Process::kHalfCut);
  // What cuts and creases in turn, and a punch, no source explains alike.
  for (const int type : {0, 5, 41, 42, 45, 97, 99}) {
    EXPECT_THAT(cf2Faults(fmt::format("L,2,{},0,0,0,10,5,0,0\n", type)),
                HasSubstr(fmt::format(":11: lines like this one are of type {}", type)));
  }
}

TEST(Cf2, ArcsRunTheWayThatIsStated) {
  const Dieline dieline = readCf2Text(
      "A,2,1,0,10,0,0,10,0,0,1,0,0\nA,2,1,0,10,0,0,10,0,0,-1,0,0\n"
      "A,2,1,0,10,0,10,0,0,0,+1,0,0\nA,2,1,0,10,0,10,0,0,0,-1\n");
  const double quarter = std::numbers::pi / 2;
  const std::vector<double> sweeps{quarter, -3 * quarter, 4 * quarter, -4 * quarter};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& arc = std::get<ArcCurve>(dieline.entities[i].curve);
    EXPECT_NEAR(arc.sweep_rad, sweeps[i], 1e-12);
    EXPECT_NEAR(arc.radius_mm, 10, 1e-12);
    EXPECT_NEAR((pointAt(arc, 0) - Vector2d(10, 0)).norm(), 0, 1e-12);
  }
}

/// Two decimals is all that many programs write. The lines beside an arc meet its ends, so these hold.
TEST(Cf2, ArcsWithRoundedCentresKeepTheirEnds) {
  const auto rounded = [](double v) { return std::round(v * 100) / 100; };
  const Vector2d centre(12.3456, 7.8912);
  const double radius = 6.789;
  double worst = 0;
  for (int i = 0; i < 40; ++i) {
    const double from = 0.157 * i;
    const double to = from + 0.4 + 0.05 * i;
    const Vector2d p = centre + radius * Vector2d(std::cos(from), std::sin(from));
    const Vector2d q = centre + radius * Vector2d(std::cos(to), std::sin(to));
    const Dieline dieline =
        readCf2Text(fmt::format("A,2,1,0,{},{},{},{},{},{},1,0,0\n", rounded(p.x()), rounded(p.y()),
                                rounded(q.x()), rounded(q.y()), rounded(centre.x()), rounded(centre.y())));
    const Curve& arc = dieline.entities[0].curve;
    EXPECT_NEAR((pointAt(arc, 0) - Vector2d(rounded(p.x()), rounded(p.y()))).norm(), 0, 1e-9);
    EXPECT_NEAR((pointAt(arc, 1) - Vector2d(rounded(q.x()), rounded(q.y()))).norm(), 0, 1e-9);
    for (int k = 0; k <= 20; ++k)
      worst = std::max(worst, std::abs((pointAt(arc, k / 20.0) - centre).norm() - radius));
  }
  EXPECT_LT(worst, 0.03);
  EXPECT_THAT(cf2Faults("A,2,1,0,10,0,0,10.2,0,0,1,0,0\n"), HasSubstr("the centre of A is 0.14"));
  EXPECT_THAT(cf2Faults("A,2,1,0,1,1,1,1,1,1,1,0,0\n"), HasSubstr("no radius"));
  EXPECT_THAT(cf2Faults("A,2,1,0,10,0,0,10,0,0,0,0,0\n"), HasSubstr("has the sense 0"));
}

TEST(Cf2, CopiesAreScaledTurnedAndShifted) {
  const Dieline dieline = readCf2Text(
      "C,ONE,100,50,90,2,1\nC,ONE,0,0,0,-1,1\n",
      "SUB,ONE\nL,2,1,0,1,2,3,2,0,0\nC,TWO,5,0,0,1,1\nEND\nSUB,TWO\nA,2,2,0,1,0,0,1,0,0,1,0,0\nEND\n");
  ASSERT_EQ(dieline.entities.size(), 4U);
  // (1, 2) scaled to (2, 2), turned to (-2, 2), shifted.
  EXPECT_NEAR((pointAt(dieline.entities[0].curve, 0) - Vector2d(98, 52)).norm(), 0, 1e-12);
  EXPECT_NEAR((pointAt(dieline.entities[0].curve, 1) - Vector2d(98, 56)).norm(), 0, 1e-12);
  // Stretched, a circle is an ellipse.
  EXPECT_TRUE(std::holds_alternative<EllipseCurve>(dieline.entities[1].curve));
  EXPECT_NEAR((pointAt(dieline.entities[1].curve, 0) - Vector2d(100, 62)).norm(), 0, 1e-12);
  EXPECT_NEAR((pointAt(dieline.entities[2].curve, 1) - Vector2d(-3, 2)).norm(), 0, 1e-12);
  const auto& mirrored = std::get<ArcCurve>(dieline.entities[3].curve);
  EXPECT_NEAR(mirrored.sweep_rad, -std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR((pointAt(mirrored, 0) - Vector2d(-6, 0)).norm(), 0, 1e-12);
}

TEST(Cf2, InchesAreInches) {
  const Dieline dieline = readText(".cff2", cf2("L,2,1,0,1,2,3,2,0,0\n", "", "UI\n"));
  EXPECT_NEAR(lengthOf(dieline.entities[0].curve), 50.8, 1e-12);
  EXPECT_THAT(cf2Faults("L,2,1,0,1,2,3,2,0,0\n", "", ""), HasSubstr("neither UM nor UI"));
  EXPECT_THAT(cf2Faults("UI\n"), HasSubstr("both UM and UI"));
  EXPECT_THAT(cf2Faults("SCALE,0.5,0.5\n"), HasSubstr("export it 1 : 1"));
}

TEST(Cf2, WhatALaserDoesNotHaveIsTold) {
  const Dieline dieline = readCf2Text(
      "L,2,1,0,0,0,10,0,3,0.8\nL,2,1,0,0,5,10,5,2,0.8\nT,1,46,0,5,5,0,4,3\nL,2,1,0,not a line but words\n",
      "SUB,SPARE\nL,2,1,0,0,0,1,1,0,0\nEND\n");
  EXPECT_EQ(dieline.entities.size(), 2U);
  EXPECT_THAT(dieline.notes, Contains(HasSubstr("1 texts")));
  EXPECT_THAT(dieline.notes, Contains(HasSubstr("5 bridges of 2 lines")));
  EXPECT_THAT(dieline.notes, Contains(HasSubstr("SUB 'SPARE', which nothing places")));
  EXPECT_THAT(readCf2Text("L,2,1,0,0,0,10,0,0,0\n").notes, IsEmpty());
}

/// Files as other programs write them: blanks behind commas, DOS and Macintosh ends of lines, no $EOF.
TEST(Cf2, HabitsOfWritersAreTaken) {
  const std::string text =
      "$BOF\r\nV2\r\nORDER\r\n%1 : tool\r\nEND\r\nMAIN, tool\r\nUM\r\nC,MODEL0, 0 ,0,0,1,1\r\n"
      "END\r\nSUB,MODEL0\r\nL,1,1,0, 0,0,5,5,0,0.0\r\nEND\r\n";
  for (const std::string end : {"\r\n", "\n", "\r"}) {
    std::string other;
    for (const char c : text) other += c == '\r' ? "" : c == '\n' ? end : std::string(1, c);
    const Dieline dieline = readText(".cf2", other);
    ASSERT_EQ(dieline.entities.size(), 1U);
    EXPECT_EQ(dieline.entities[0].origin, "line 11: L of 1 pt");
    EXPECT_THAT(dieline.notes, Contains(HasSubstr("no $EOF")));
  }
}

TEST(Cf2, ContentTellsTheFormatOfOtherExtensions) {
  EXPECT_EQ(readText(".die", cf2("L,2,1,0,0,0,10,0,0,0\n")).entities.size(), 1U);
  EXPECT_EQ(readText(".CFF", cf2("L,2,1,0,0,0,10,0,0,0\n")).entities.size(), 1U);
}

TEST(HostileCf2, IsToldWhereItBreaks) {
  EXPECT_THAT(cf2Faults("L,2,1,0,0,0,10\n"), HasSubstr(":11: L has 6 fields, 7 are needed"));
  EXPECT_THAT(cf2Faults("L,2,x,0,0,0,10,5\n"), HasSubstr(":11: L has no type of line"));
  EXPECT_THAT(cf2Faults("L,2,1,0,1e308,0,10,5\n"),
              HasSubstr("field 4 of L is no number of a drawing: '1e308'"));
  EXPECT_THAT(cf2Faults("A,2,1,0,0,nan,10,5,0,0,1\n"), HasSubstr("field 5 of A is no number"));
  EXPECT_THAT(cf2Faults("L,2,1,0,0,0,10,5,1.5,1\n"), HasSubstr("has '1.5' bridges"));
  EXPECT_THAT(cf2Faults("Q,1,2\n"), HasSubstr(":11: record 'Q' is not known"));
  EXPECT_THAT(cf2Faults("C,NONE,0,0,0,1,1\n"), HasSubstr("C of 'NONE', which is not in the file"));
  EXPECT_THAT(cf2Faults("C,A,0,0,0,0,1\n", "SUB,A\nEND\n"), HasSubstr("flattens 'A' to nothing"));
  EXPECT_THAT(cf2Faults("", "SUB,A\nEND\nSUB,A\nEND\n"), HasSubstr("a second SUB 'A'"));
  EXPECT_THAT(cf2Faults("", "SUB,A\nL,2,1,0,0,0,10,5\n"), HasSubstr("'SUB A' is never ended"));
  EXPECT_THAT(cf2Faults("", "L,2,1,0,0,0,10,5\n"), HasSubstr("outside of MAIN and SUB"));
  EXPECT_THAT(faultsOf(".cf2", "$BOF\nV2\n$EOF\n"), HasSubstr("has no MAIN"));
  EXPECT_THAT(faultsOf(".cf2", "root:x:0:0\nroot:x:0:0\n"), HasSubstr(":1: begins with no record of CF2"));
  EXPECT_EQ(faultsOf(".cf2", "root:x:0:0\n").find("root"), std::string::npos);
  EXPECT_THAT(faultsOf(".cf2", "$BOF\nV2\nORDER\n"), HasSubstr("'ORDER' is never ended"));
  EXPECT_THAT(faultsOf(".cf2", "$BOF\nV1\nMAIN,A\n"), HasSubstr("save it as CFF2"));
}

TEST(Cf2, AUnitThatTheFileSaysItselfIsRefused) {
  DrawingOptions options;
  options.unit = DrawingUnit::kInch;
  EXPECT_THAT(faultsOf(".cf2", cf2("L,2,1,0,0,0,10,5,0,0\n"), options), HasSubstr("says its unit itself"));
  options.unit.reset();
  options.scale = 2.0;
  const Dieline twice = readText(".cf2", cf2("L,2,1,0,0,0,10,5,0,0\n"), options);
  EXPECT_NEAR(twice.bounds().max().x(), 20.0, 1e-9);
}

TEST(HostileCf2, BlocksThatHoldThemselvesOrUnfoldWithoutBoundEnd) {
  EXPECT_THAT(cf2Faults("C,A,0,0,0,1,1\n",
                        "SUB,A\nC,B,0,0,0,1,1\nC,B,0,0,0,1,1\nEND\n"
                        "SUB,B\nC,A,0,0,0,1,1\nC,A,0,0,0,1,1\nEND\n"),
              HasSubstr("nested deeper than 16"));
  std::string subs;
  for (int i = 0; i < 12; ++i) {
    subs += fmt::format("SUB,S{}\n", i);
    for (int k = 0; k < 10; ++k) subs += fmt::format("C,S{},0,0,0,1,1\n", i + 1);
    subs += "END\n";
  }
  EXPECT_THAT(cf2Faults("C,S0,0,0,0,1,1\n", subs + "SUB,S12\nEND\n"),
              HasSubstr("more than 1000000 entities"));
  // SUBs that were counted before they are placed: their levels count all the same.
  std::string mains, chain = "SUB,S0\nL,2,1,0,0,0,1,1\nEND\n";
  for (int i = 1; i <= 40; ++i) {
    mains += fmt::format("C,S{},0,0,0,1,1\n", i);
    chain += fmt::format("SUB,S{}\nC,S{},0,0,0,1,1\nEND\n", i, i - 1);
  }
  EXPECT_THAT(cf2Faults(mains, chain), HasSubstr("'S15' is nested deeper than 16"));
  std::string deep;
  for (int i = 0; i < 14; ++i) deep += fmt::format("SUB,S{}\nC,S{},0,0,0,1e6,1e6\nEND\n", i, i + 1);
  EXPECT_THAT(cf2Faults("C,S0,0,0,0,1,1\n", deep + "SUB,S14\nL,2,1,0,0,0,1,1\nEND\n"),
              HasSubstr("wrong units or scale?"));
}

}  // namespace
}  // namespace kerfbench::dieline
