// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/dieline/read.h"
#include "tests/hil/dieline/files.h"

namespace kerfbench::dieline {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;
using testing::HasSubstr;

constexpr double kTiny = 1e-9;

std::vector<Curve> curvesOf(const std::string& body) {
  std::vector<Curve> curves;
  for (const Entity& entity : readText(".svg", svg("<g stroke='black'>" + body + "</g>")).entities)
    curves.push_back(entity.curve);
  return curves;
}
/// Checks points of curve 0, given in the drawing's own coordinates (y down on 50 mm).
void expectPoint(const Curve& curve, double u, double x, double y) {
  EXPECT_LT((pointAt(curve, u) - Vector2d(x, 50 - y)).norm(), kTiny) << pointAt(curve, u).transpose();
}
/// Largest distance of any point of `a` from the drawing `b`.
double farthest(const Dieline& a, const Dieline& b, const Eigen::Affine2d& X) {
  double worst = 0;
  for (const Entity& entity : a.entities) {
    for (const double u : stations(entity.curve, 0.3)) {
      double nearest = 1e99;
      for (const Entity& other : b.entities) {
        nearest = std::min(nearest, nearestOn(other.curve, X * pointAt(entity.curve, u)).distance_mm);
      }
      worst = std::max(worst, nearest);
    }
  }
  return worst;
}

TEST(Svg, LabelOfInkscapeAgreesWithTheDxf) {
  const Dieline drawn = readDieline(fixture("label-60x40.dxf"), defaultLayerProfile());
  const Dieline svg_label = readDieline(fixture("label-60x40.svg"), defaultLayerProfile());
  const Eigen::Affine2d moved(Eigen::Translation2d(60, 20));
  EXPECT_LT(farthest(drawn, svg_label, moved), 1e-6);
  EXPECT_LT(farthest(svg_label, drawn, moved.inverse()), 1e-6);
  EXPECT_EQ(svg_label.entities.size(), drawn.entities.size());
  EXPECT_EQ(svg_label.entities[0].layer, "Cut");  // The label of Inkscape's layer, not the stroke.
}

TEST(Dxf, LabelSavedByLibreCadIsTheLabel) {
  const Dieline drawn = readDieline(fixture("label-60x40.dxf"), defaultLayerProfile());
  const Dieline saved = readDieline(fixture("label-60x40-librecad.dxf"), defaultLayerProfile());
  const Eigen::Affine2d unmoved = Eigen::Affine2d::Identity();
  EXPECT_LT(farthest(drawn, saved, unmoved), 1e-6);
  EXPECT_LT(farthest(saved, drawn, unmoved), 1e-6);
}

TEST(Svg, LabelThatInkscapeTurnedAgreesWithTheTurnedDxf) {
  const Dieline drawn = readDieline(fixture("label-60x40.dxf"), defaultLayerProfile());
  const Dieline turned_label = readDieline(fixture("label-60x40-turned.svg"), defaultLayerProfile());
  Eigen::Affine2d turned = Eigen::Affine2d::Identity();
  turned.translate(Vector2d(30, 20)).rotate(pi).translate(Vector2d(30, 0));
  EXPECT_LT(farthest(drawn, turned_label, turned), 1e-6);
}

TEST(Svg, LabelAsPathsAgreesWithinTheDecimalsOfInkscape) {
  const Dieline drawn = readDieline(fixture("label-60x40.dxf"), defaultLayerProfile());
  const Dieline paths = readDieline(fixture("label-60x40-paths.svg"), defaultLayerProfile());
  // Inkscape writes 1.662 for 3 * 0.5523: the middle of each corner of 3 mm is 2.73 um too far out.
  EXPECT_NEAR(farthest(drawn, paths, Eigen::Affine2d(Eigen::Translation2d(60, 20))), 2.73e-3, 1e-5);
  EXPECT_EQ(paths.entities[0].layer, "#ff0000");
}

TEST(Svg, PathLinesAbsoluteAndRelative) {
  const auto c = curvesOf("<path d='M10,20 30-5.5.5.5l1 2H7h-2V3v4z m 1 1 2 0'/>");
  ASSERT_EQ(c.size(), 9U);
  expectPoint(c[0], 0, 10, 20);
  expectPoint(c[0], 1, 30, -5.5);
  expectPoint(c[1], 1, 0.5, 0.5);
  expectPoint(c[2], 1, 1.5, 2.5);
  expectPoint(c[3], 1, 7, 2.5);
  expectPoint(c[4], 1, 5, 2.5);
  expectPoint(c[5], 1, 5, 3);
  expectPoint(c[6], 1, 5, 7);
  expectPoint(c[7], 1, 10, 20);  // Z
  expectPoint(c[8], 0, 11, 21);  // The m behind z counts from the start of the outline.
  expectPoint(c[8], 1, 13, 21);
}

TEST(Svg, PathCurvesAbsoluteRelativeAndSmooth) {
  const auto c = curvesOf("<path d='M0 0C1 2 3 4 5 0s3-4 5 0 Q12 5 14 0 T18 0 t4 0 S 30 9 40 0 q1 1 2 0'/>");
  ASSERT_EQ(c.size(), 7U);
  for (std::size_t i = 0; i + 1 < c.size(); ++i) {
    EXPECT_LT((pointAt(c[i], 1) - pointAt(c[i + 1], 0)).norm(), kTiny);
  }
  const auto control = [&](std::size_t i, int k) {
    return Vector2d(std::get<BezierCurve>(c[i]).control_mm.col(k));
  };
  // The control point mirrors (3,4) at (5,0).
  EXPECT_LT((control(1, 1) - Vector2d(7, 50 + 4)).norm(), kTiny);
  EXPECT_LT((control(1, 2) - Vector2d(8, 50 + 4)).norm(), kTiny);
  expectPoint(c[2], 0.5, 12, 2.5);   // Middle of a quadratic curve.
  expectPoint(c[3], 0.5, 16, -2.5);  // The middle of the curve's reflection.
  expectPoint(c[4], 0.5, 20, 2.5);   // The middle of that reflection's reflection.
  // An S behind T has no control point to mirror.
  EXPECT_LT((control(5, 1) - Vector2d(22, 50)).norm(), kTiny);
}

TEST(Svg, PathArcsAreExact) {
  // Quarter circles about (10, 10) with all four flag combinations; flags need no separator.
  for (const bool large : {false, true}) {
    for (const bool positive : {false, true}) {
      const std::string flags = std::string(large ? "1" : "0") + (positive ? "1" : "0");
      const auto c = curvesOf("<path d='M15 10a5 5 0 " + flags + "-5 5'/>");
      ASSERT_EQ(c.size(), 1U);
      const auto& arc = std::get<ArcCurve>(c[0]);
      expectPoint(c[0], 0, 15, 10);
      expectPoint(c[0], 1, 10, 15);
      EXPECT_NEAR(arc.radius_mm, 5, kTiny);
      EXPECT_NEAR(std::abs(arc.sweep_rad), large ? 1.5 * pi : 0.5 * pi, kTiny);
      EXPECT_EQ(arc.sweep_rad < 0, positive);  // y is turned over.
    }
  }
  // An ellipse tilted by 30 degrees: each point fulfils its equation.
  const auto tilted = curvesOf("<path d='M0 0 A 20 8 30 0 1 25 9'/>");
  const auto& e = std::get<EllipseCurve>(tilted[0]);
  EXPECT_NEAR(e.major_mm.norm(), 20, kTiny);
  EXPECT_NEAR(e.minor_mm.norm(), 8, kTiny);
  EXPECT_NEAR(std::atan2(e.major_mm.y(), e.major_mm.x()), -pi / 6, kTiny);
  expectPoint(tilted[0], 0, 0, 0);
  expectPoint(tilted[0], 1, 25, 9);
  // Radii that are too small grow until they reach: a half circle.
  const auto grown = curvesOf("<path d='M0 0 A 1 1 0 0 1 10 0'/>");
  EXPECT_NEAR(std::get<ArcCurve>(grown[0]).radius_mm, 5, kTiny);
  EXPECT_TRUE(std::holds_alternative<LineCurve>(curvesOf("<path d='M0 0 A 0 3 0 0 1 10 0'/>")[0]));
}

TEST(Svg, BasicShapes) {
  EXPECT_LT(
      apart(curvesOf("<circle cx='4' cy='5' r='2mm'/>")[0], ArcCurve{{4, 45}, 2 * 96 / 25.4, 0, -2 * pi}),
      kTiny);
  EXPECT_LT(apart(curvesOf("<ellipse cx='4' cy='5' rx='2' ry='3'/>")[0],
                  EllipseCurve{{4, 45}, {2, 0}, {0, -3}, 0, 2 * pi}),
            kTiny);
  EXPECT_LT(apart(curvesOf("<line x1='1' y1='2' x2='3' y2='4'/>")[0], LineCurve{{1, 48}, {3, 46}}), kTiny);
  EXPECT_EQ(curvesOf("<polyline points='0,0 10,0 10,10'/>").size(), 2U);
  EXPECT_EQ(curvesOf("<polygon points='0,0 10,0 10,10'/>").size(), 3U);
  EXPECT_EQ(curvesOf("<rect x='1' y='2' width='10' height='5'/>").size(), 4U);
  EXPECT_EQ(curvesOf("<rect width='0' height='5'/>").size(), 0U);
  const auto rounded = curvesOf("<rect x='1' y='2' width='10' height='6' rx='2' ry='1'/>");
  ASSERT_EQ(rounded.size(), 8U);
  EXPECT_TRUE(std::holds_alternative<EllipseCurve>(rounded[1]));
  for (std::size_t i = 0; i < 8; ++i)
    EXPECT_LT((pointAt(rounded[i], 1) - pointAt(rounded[(i + 1) % 8], 0)).norm(), kTiny);
  // Radii are cut to half the side: a stadium has two straight sides.
  EXPECT_EQ(curvesOf("<rect width='20' height='6' ry='9' rx='3'/>").size(), 6U);
}

TEST(Svg, NestedTransformsApplyOutermostLast) {
  const auto c = curvesOf(
      "<g transform='translate(10 5) rotate(90)'><g transform='scale(2,3)'><g transform='skewX(45)'>"
      "<line x2='1' y2='1' transform='matrix(1 0 0 1 4 0) rotate(180,1,1) skewY(0)'/></g></g></g>");
  const auto image = [](Vector2d p) {
    p = Vector2d(2 - p.x(), 2 - p.y()) + Vector2d(4, 0);
    p = Vector2d(p.x() + p.y(), p.y());
    p = Vector2d(2 * p.x(), 3 * p.y());
    return Vector2d(Vector2d(-p.y(), p.x()) + Vector2d(10, 5));
  };
  expectPoint(c[0], 0, image({0, 0}).x(), image({0, 0}).y());
  expectPoint(c[0], 1, image({1, 1}).x(), image({1, 1}).y());
}

TEST(Svg, UseSymbolAndNestedSvgArePlaced) {
  const auto c = curvesOf(
      "<defs><line id='a' x2='1'/><symbol id='s' viewBox='0 0 10 10'><line x2='10'/></symbol></defs>"
      "<use href='#a' x='5' y='6' transform='scale(2)'/><use xlink:href='#s' x='1' y='2' width='20' "
      "height='40'/>"
      "<svg x='3' y='4' width='5' height='5' viewBox='1 1 10 10'><line x1='1' y1='1' x2='11' y2='1'/></svg>");
  ASSERT_EQ(c.size(), 3U);
  expectPoint(c[0], 0, 10, 12);
  expectPoint(c[0], 1, 12, 12);
  expectPoint(c[1], 0, 1, 12);  // The width of 20 fits; the height of 40 - 20 is halved above.
  expectPoint(c[1], 1, 21, 12);
  expectPoint(c[2], 0, 3, 4);
  expectPoint(c[2], 1, 8, 4);
}

TEST(Svg, UnitsAndViewBoxScaleThePage) {
  const auto end = [](const std::string& attributes) {
    return pointAt(
        readText(".svg", svg("<line stroke='black' x2='10' y2='0'/>", attributes)).entities.at(0).curve, 1);
  };
  EXPECT_LT((end("width='10cm' height='50mm' viewBox='0 0 100 50'") - Vector2d(10, 50)).norm(), kTiny);
  EXPECT_LT((end("width='2in' height='1in' viewBox='0 0 200 100'") - Vector2d(2.54, 25.4)).norm(), kTiny);
  EXPECT_LT((end("width='72pt' height='6pc'") - Vector2d(10 * 25.4 / 96, 25.4)).norm(), kTiny);
  EXPECT_LT((end("width='100mm' height='100mm' viewBox='-5 -5 50 100'") - Vector2d(25 + 15, 95)).norm(),
            kTiny);
  EXPECT_LT((end("width='100mm' height='100mm' viewBox='0 0 50 100' preserveAspectRatio='xMaxYMid meet'") -
             Vector2d(60, 100))
                .norm(),
            kTiny);
  EXPECT_LT((end("width='100mm' height='100mm' viewBox='0 0 50 100' preserveAspectRatio='none'") -
             Vector2d(20, 100))
                .norm(),
            kTiny);
}

TEST(Svg, StrokesAreNormalisedAndInherited) {
  const auto layer = [](const std::string& body) {
    return readText(".svg", svg(body), LayerProfile{"all", {{"*", Process::kCut}}}).entities.at(0).layer;
  };
  EXPECT_EQ(layer("<line x2='9' stroke='Red'/>"), "#ff0000");
  EXPECT_EQ(layer("<line x2='9' stroke='#F0a'/>"), "#ff00aa");
  EXPECT_EQ(layer("<line x2='9' style='fill:none; stroke: rgb(0, 128,255) !important'/>"), "#0080ff");
  EXPECT_EQ(layer("<line x2='9' stroke='rgb(100%,0%,0%)'/>"), "#ff0000");
  EXPECT_EQ(layer("<g stroke='blue'><g><line x2='9'/></g></g>"), "#0000ff");
  EXPECT_EQ(layer("<g stroke='blue'><line x2='9' stroke='red' style='stroke:lime'/></g>"), "#00ff00");
  EXPECT_EQ(layer("<style>/* by a program */ .a,.cut{stroke:#123456;fill:none}</style><line class='x cut' "
                  "stroke='red' x2='9'/>"),
            "#123456");
  EXPECT_EQ(readText(".svg", svg("<line x2='9'/>"), LayerProfile{"all", {{"none", Process::kCut}}})
                .entities.at(0)
                .layer,
            "none");
}

TEST(Svg, LayerNamesOfInkscapeCountWhereTheProfileKnowsThem) {
  const auto entity = [](const std::string& label) {
    return readText(".svg", svg("<g inkscape:groupmode='layer' inkscape:label='" + label +
                                "'><line x2='9' stroke='black'/></g>"))
        .entities.at(0);
  };
  EXPECT_EQ(entity("Crease").process, Process::kCrease);
  EXPECT_EQ(entity("Crease").layer, "Crease");
  EXPECT_EQ(entity("Layer 1").process, Process::kCut);
  EXPECT_EQ(entity("Layer 1").layer, "#000000");
}

TEST(Svg, WhatIsNotDisplayedIsSkipped) {
  EXPECT_EQ(
      curvesOf("<g style='display:none'><line x2='9'/><text>x</text></g><line visibility='hidden' x2='9'/>")
          .size(),
      0U);
}

TEST(Svg, WhatItCannotTakeIsAFaultAtItsLine) {
  const auto faults = [](const std::string& body) { return faultsOf(".svg", svg(body)); };
  EXPECT_EQ(faults("<g stroke='red'>\n<text>hello</text></g>"), "");
  EXPECT_THAT(faults("\n\n<line x2='9' stroke='#abcdef'/>"), HasSubstr(":4: line on layer '#abcdef'"));
  EXPECT_THAT(faults("<line x2='9' stroke='url(#g)'/>"), HasSubstr("no plain colour"));
  EXPECT_THAT(faults("<mesh stroke='red'/>"), HasSubstr("element mesh"));
  EXPECT_THAT(faults("<line x2='9' stroke='red' clip-path='url(#c)'/>"),
              HasSubstr("which is not in the file"));
  EXPECT_THAT(faults("<line x2='9em' stroke='red'/>"), HasSubstr("x2 is no length"));
  EXPECT_THAT(faults("<style>g + line {stroke:red}</style>"), HasSubstr("style selector"));
  EXPECT_THAT(faults("<use href='#nobody'/>"), HasSubstr("not in the file"));
  EXPECT_EQ(faults("<g inkscape:groupmode='layer' inkscape:label='notes'><text>hello</text></g>"), "");
}

TEST(Svg, OriginNamesTheLineTheElementAndTheCommand) {
  const Dieline dieline = readText(".svg", svg("<path stroke='red'\n d='M0 0 L1 1 L2 0'/>"));
  EXPECT_EQ(dieline.entities.at(1).origin, "line 2: path command 3");
}

}  // namespace
}  // namespace kerfbench::dieline
