// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/dieline/read.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;
using testing::HasSubstr;

constexpr double kTiny = 1e-9;

Curve only(const Dieline& dieline) {
  EXPECT_EQ(dieline.entities.size(), 1U);
  return dieline.entities.at(0).curve;
}
void expectPoint(const Curve& curve, double u, const Vector2d& p_mm) {
  EXPECT_LT((pointAt(curve, u) - p_mm).norm(), kTiny)
      << pointAt(curve, u).transpose() << " is not " << p_mm.transpose();
}

class DxfVersion : public testing::TestWithParam<std::string> {};

TEST_P(DxfVersion, GivesEachEntityAsDrawn) {
  const Dieline dieline =
      readDieline(fixture("reader/entities-" + GetParam() + ".dxf"), defaultLayerProfile());
  std::vector<Curve> c;
  for (const Entity& entity : dieline.entities) c.push_back(entity.curve);
  const bool is_old = GetParam() == "R12";
  ASSERT_EQ(c.size(), is_old ? 19U : 26U);
  expectPoint(c[0], 1, {1.0 / 3, 2.123456789012345});
  EXPECT_LT(apart(c[1], ArcCurve{{10, 20}, 3, pi / 6, 1.5 * pi}), kTiny);
  EXPECT_EQ(dieline.entities[1].process, Process::kCrease);
  EXPECT_LT(apart(c[2], ArcCurve{{1, 2}, 5, 0, 2 * pi}), kTiny);
  EXPECT_LT(apart(c[3], ArcCurve{{5, 0}, 5, pi, pi}), kTiny);  // Bulge 1: a half circle below the chord.
  EXPECT_LT(apart(c[4], LineCurve{{10, 0}, {10, 10}}), kTiny);
  std::size_t next = 5;
  if (!is_old) {
    // The bulge is 0.5 from (0,0) to (1,0): sagitta 0.25 below the chord.
    expectPoint(c[5], 0.5, {0.5, -0.25});
    EXPECT_LT(apart(c[6], LineCurve{{1, 0}, {1, 1}}), kTiny);
    expectPoint(c[7], 0, {1, 1});
    expectPoint(c[7], 1, {0, 0});
    const Vector2d middle(0.5, 0.5);
    // The arc is clockwise, so on the left of (1,1) -> (0,0), by a sagitta of a quarter of half the chord.
    const Vector2d left = Vector2d(1, -1).normalized() * (0.25 * std::sqrt(2.0) / 2);
    expectPoint(c[7], 0.5, middle + left);
    EXPECT_LT(apart(c[8], EllipseCurve{{1, 2}, {3, 4}, {-2, 1.5}, 0.1, 1.9}), kTiny);
    expectPoint(c[9], 0, {0, 0});
    expectPoint(c[10], 1, {5, 0});
    expectPoint(c[9], 1, pointAt(c[10], 0));
    for (int i = 0; i <= 10; ++i) EXPECT_NEAR(pointAt(c[11], i / 10.0).norm(), 1, 1e-12);
    EXPECT_TRUE(std::holds_alternative<BezierCurve>(c[11]));
    EXPECT_EQ(dieline.entities[10].origin.substr(dieline.entities[10].origin.size() - 13), "SPLINE span 2");
    next = 12;
  }
  // The block PART is turned by 90 degrees in OUTER, which is mirrored, doubled and turned by 30 degrees
  // about (5, 5).
  Eigen::Affine2d outer = Eigen::Affine2d::Identity();
  outer.translate(Vector2d(5, 5))
      .rotate(pi / 6)
      .scale(Vector2d(-2, 2))
      .rotate(pi / 2)
      .translate(Vector2d(-1, 0));
  EXPECT_LT(apart(c[next], LineCurve{outer * Vector2d(1, 0), outer * Vector2d(2, 1)}), kTiny);
  EXPECT_LT(apart(c[next + 1], transformed(ArcCurve{{1, 0}, 2, 0, pi / 2}, outer)), kTiny);
  EXPECT_LT(std::get<ArcCurve>(c[next + 1]).sweep_rad, 0);
  EXPECT_EQ(dieline.entities[next].layer, "CREASE");  // Layer 0 of a block takes the layer of its INSERT.
  // The array of 3 columns and 2 rows.
  for (std::size_t k = 0; k < 6; ++k) {
    const Vector2d at(100 + 8.0 * static_cast<double>(k % 3), 7.0 * static_cast<double>(k / 3));
    EXPECT_LT(apart(c[next + 2 + 2 * k], LineCurve{at, at + Vector2d(1, 1)}), kTiny);
  }
}
INSTANTIATE_TEST_SUITE_P(Versions, DxfVersion, testing::Values("R12", "R2000", "R2007", "R2010", "R2018"));

TEST(Dxf, UnitsScaleTheDrawing) {
  const auto end = [](const std::string& header) {
    return pointAt(only(readText(".dxf", dxf("0|LINE|8|CUT|10|0|20|0|11|1|21|2", header))), 1).y();
  };
  EXPECT_EQ(end("9|$INSUNITS|70|1"), 50.8);
  EXPECT_EQ(end("9|$INSUNITS|70|4"), 2);
  EXPECT_EQ(end("9|$INSUNITS|70|5"), 20);
  EXPECT_EQ(end("9|$INSUNITS|70|6"), 2000);
  EXPECT_EQ(end("9|$MEASUREMENT|70|0"), 50.8);
  EXPECT_EQ(end("9|$MEASUREMENT|70|1"), 2);
  EXPECT_EQ(end(""), 2);
  EXPECT_THAT(faultsOf(".dxf", dxf("", "9|$INSUNITS|70|3")), HasSubstr("$INSUNITS 3"));
}

TEST(Dxf, ADownwardExtrusionMirrorsWhatIsInItsPlane) {
  EXPECT_LT(apart(only(readText(".dxf", dxf("0|CIRCLE|8|CUT|10|5|20|1|40|2|230|-1"))),
                  ArcCurve{{-5, 1}, 2, 0, 2 * pi}),
            kTiny);
  EXPECT_LT(apart(only(readText(".dxf", dxf("0|ARC|8|CUT|10|5|20|1|40|2|50|0|51|90|230|-1.0"))),
                  ArcCurve{{-5, 1}, 2, pi, -pi / 2}),
            kTiny);
  // A polyline with a bulge is the mirror image of the same polyline without the extrusion.
  const std::string poly = "0|LWPOLYLINE|8|CUT|90|2|70|0|10|1|20|0|42|0.4|10|3|20|1";
  Eigen::Affine2d mirror(Eigen::Scaling(-1.0, 1.0));
  EXPECT_LT(apart(only(readText(".dxf", dxf(poly + "|230|-1"))),
                  transformed(only(readText(".dxf", dxf(poly))), mirror)),
            kTiny);
  // Ends of lines and the centre and axis of ellipses are in the world: only the ellipse's sense turns.
  EXPECT_LT(apart(only(readText(".dxf", dxf("0|LINE|8|CUT|10|1|20|2|11|3|21|4|230|-1"))),
                  LineCurve{{1, 2}, {3, 4}}),
            kTiny);
  EXPECT_LT(apart(only(readText(".dxf", dxf("0|ELLIPSE|8|CUT|10|1|20|2|11|3|21|0|40|0.5|41|0|42|1|230|-1"))),
                  EllipseCurve{{1, 2}, {3, 0}, {0, -1.5}, 0, 1}),
            kTiny);
  const std::string block = "0|BLOCK|2|B|10|0|20|0|0|LINE|8|0|10|1|20|0|11|2|21|1|0|ENDBLK";
  EXPECT_LT(apart(only(readText(".dxf", dxf("0|INSERT|8|CUT|2|B|10|10|20|5|50|90|230|-1", "", block))),
                  LineCurve{{-10, 6}, {-9, 7}}),
            kTiny);
  EXPECT_THAT(faultsOf(".dxf", dxf("0|CIRCLE|8|CUT|10|5|20|1|40|2|210|1|220|0|230|0")), HasSubstr("tilted"));
}

TEST(Dxf, OriginNamesTheLineAndTheSegment) {
  const Dieline dieline = readText(".dxf", dxf("0|LWPOLYLINE|8|CUT|90|3|70|0|10|0|20|0|10|1|20|0|10|1|20|1"));
  ASSERT_EQ(dieline.entities.size(), 2U);
  EXPECT_EQ(dieline.entities[1].origin, "line 6: LWPOLYLINE segment 2");
  EXPECT_EQ(dieline.entities[1].id, 1);
}

TEST(Dxf, LayersCompareWithoutCaseAndUnknownOnesAreFaults) {
  const std::string line = "|10|0|20|0|11|1|21|2";
  EXPECT_EQ(readText(".dxf", dxf("0|LINE|8|cReAsE" + line)).entities[0].process, Process::kCrease);
  const std::string faults = faultsOf(".dxf", dxf("0|LINE|8|Varnish" + line + "|0|LINE|8|Emboss" + line));
  EXPECT_THAT(faults, HasSubstr("6: LINE on layer 'Varnish'"));
  EXPECT_THAT(faults, HasSubstr("18: LINE on layer 'Emboss'"));
  LayerProfile all{"all", {{"*", Process::kHalfCut}, {"Emboss", Process::kIgnore}}};
  const Dieline dieline = readText(".dxf", dxf("0|LINE|8|Varnish" + line + "|0|LINE|8|EMBOSS" + line), all);
  EXPECT_EQ(dieline.entities[0].process, Process::kHalfCut);
  EXPECT_EQ(dieline.entities[1].process, Process::kIgnore);
}

TEST(Dxf, WhatItCannotTakeIsRefusedByName) {
  EXPECT_THAT(
      faultsOf(".dxf",
               dxf("0|SPLINE|8|CUT|71|5|10|0|20|0|10|1|20|1|10|2|20|2|10|3|20|3|10|4|20|4|10|5|20|5")),
      HasSubstr("degree 5 is not supported"));
  EXPECT_THAT(faultsOf(".dxf", dxf("0|SPLINE|8|CUT|71|3|11|0|21|0|11|1|21|1")), HasSubstr("fit points only"));
  EXPECT_THAT(faultsOf(".dxf", dxf("0|LINE|8|CUT|10|0|20|0|30|0|11|1|21|1|31|4")), HasSubstr("not flat"));
  EXPECT_THAT(faultsOf(".dxf", dxf("0|POLYLINE|8|CUT|70|64|0|SEQEND")), HasSubstr("mesh"));
  EXPECT_THAT(faultsOf(".dxf", dxf("0|INSERT|8|CUT|2|NOWHERE|10|0|20|0")),
              HasSubstr("'NOWHERE', which is not defined"));
}

TEST(Dxf, PaperSpaceIsNoPartOfTheDieline) {
  EXPECT_EQ(readText(".dxf", dxf("0|LINE|67|1|8|frame|10|0|20|0|11|1|21|2")).entities.size(), 0U);
}

TEST(Dxf, LineEndsOfWindowsAndAByteOrderMarkAreRead) {
  std::string text = dxf("0|LINE|8|CUT|10|0|20|0|11|1|21|2");
  std::string windows = "\xEF\xBB\xBF";
  for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(readText(".dxf", windows).entities[0].origin, "line 6: LINE");
}

TEST(Dxf, FixturesLieWhereTheyAreSaidToLie) {
  const auto box = [](const char* name) {
    return readDieline(fixture(name), defaultLayerProfile()).bounds();
  };
  EXPECT_TRUE(
      box("label-60x40.dxf").isApprox(Eigen::AlignedBox2d(Vector2d(-60, -20), Vector2d(0, 20)), 1e-9));
  EXPECT_TRUE(
      box("tuck-end-carton.dxf").isApprox(Eigen::AlignedBox2d(Vector2d(-142, -68), Vector2d(0, 68)), 1e-9));
  EXPECT_TRUE(
      box("strip-crosscut.dxf").isApprox(Eigen::AlignedBox2d(Vector2d(0, -400), Vector2d(0, 400)), 1e-9));
}

TEST(Dxf, TheCouponHoldsThreeProcesses) {
  int cuts = 0;
  int half_cuts = 0;
  int perforations = 0;
  for (const Entity& entity : readDieline(fixture("coupon-perforated.dxf"), defaultLayerProfile()).entities) {
    cuts += entity.process == Process::kCut ? 1 : 0;
    half_cuts += entity.process == Process::kHalfCut ? 1 : 0;
    perforations += entity.process == Process::kPerforation ? 1 : 0;
  }
  EXPECT_EQ(cuts, 4);
  EXPECT_EQ(half_cuts, 8);
  EXPECT_EQ(perforations, 1);
}

}  // namespace
}  // namespace kerfbench::dieline
