// SPDX-License-Identifier: Apache-2.0
#include "hil/drawing/drawing_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "hil/base/png_codec.h"

namespace kerfbench::drawing {
namespace {

using dieline::Process;
using ::testing::HasSubstr;
using ::testing::Not;

void addLine(dieline::Dieline& dieline, Process process, const std::string& layer, Eigen::Vector2d from,
             Eigen::Vector2d to) {
  const int id = static_cast<int>(dieline.entities.size());
  dieline.entities.push_back({id, dieline::LineCurve{from, to}, process, layer, "line 1: LINE", {}});
}

void addCircle(dieline::Dieline& dieline, Eigen::Vector2d centre, double radius_mm) {
  const int id = static_cast<int>(dieline.entities.size());
  dieline.entities.push_back({id,
                              dieline::ArcCurve{centre, radius_mm, 0.0, 2.0 * std::numbers::pi},
                              Process::kCut,
                              "cut",
                              "line 1",
                              {}});
}

// A square of 100 mm with a hole of 20 mm, in which a disc of 5 mm is cut, and a crease.
dieline::Dieline plate() {
  dieline::Dieline dieline;
  const std::vector<Eigen::Vector2d> corners{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
  for (std::size_t i = 0; i < 4; ++i)
    addLine(dieline, Process::kCut, "cut", corners[i], corners[(i + 1) % 4]);
  addCircle(dieline, {30, 30}, 20.0);
  addCircle(dieline, {30, 30}, 5.0);
  addLine(dieline, Process::kCrease, "fold", {60, 0}, {60, 100});
  return dieline;
}

base::PngSamples decoded(const dieline::Dieline& dieline, const PictureContent& content) {
  const auto samples = base::decodePng(pngOf(dieline, content), base::PngColours::kRgb);
  if (!samples) throw std::runtime_error("no PNG");
  return *samples;
}

// Mean of red, green, blue in a square of 5 px around a place of the plate, whose scale is known from the
// picture's width: 64 px are left free at each side.
std::array<int, 3> colourAt(const base::PngSamples& picture, const Eigen::Vector2d& p_mm) {
  const double px_per_mm = (picture.width_px - 128.0) / 100.0;
  const int x = static_cast<int>(std::lround(64.0 + px_per_mm * p_mm.x()));
  const int y = static_cast<int>(std::lround(40.0 + 64.0 + px_per_mm * (100.0 - p_mm.y())));
  const auto at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width_px) +
                       static_cast<std::size_t>(x));
  return {picture.bytes[at], picture.bytes[at + 1], picture.bytes[at + 2]};
}

bool isWhite(const std::array<int, 3>& rgb) { return rgb[0] > 250 && rgb[1] > 250 && rgb[2] > 250; }

TEST(DrawingPicture, CountsNoFaultTwice) {
  dieline::Dieline dieline = plate();
  addLine(dieline, Process::kCut, "cut", {0, 0}, {100, 0});
  const PictureContent content = contentOf(dieline, "plate", 800, {});
  EXPECT_EQ(content.findings.size(), 1U);
  EXPECT_THAT(content.notes, testing::IsEmpty()) << "no more than the one fault that is marked";
}

TEST(DrawingPicture, ShadesPiecesAndLeavesHolesWhite) {
  const base::PngSamples picture = decoded(plate(), {.title = "plate.dxf", .width_px = 828});
  // Away from the lines of the scale, which are drawn at round numbers.
  EXPECT_FALSE(isWhite(colourAt(picture, {83.3, 73.3}))) << "the plate";
  EXPECT_TRUE(isWhite(colourAt(picture, {43.3, 33.3}))) << "its hole";
  EXPECT_FALSE(isWhite(colourAt(picture, {31.7, 31.7}))) << "the piece in the hole";
  EXPECT_EQ(colourAt(picture, {83.3, 73.3}), colourAt(picture, {31.7, 31.7}));
}

TEST(DrawingPicture, DrawsEachProcessInItsColour) {
  const base::PngSamples picture = decoded(plate(), {.title = "plate.dxf", .width_px = 828});
  const auto cut = colourAt(picture, {0.0, 53.3});
  EXPECT_GT(cut[0], cut[2] + 60) << "cuts are red";
  // The crease is dashed: along it there is blue, and there are gaps.
  int blue = 0;
  int gaps = 0;
  for (double y_mm = 12.0; y_mm < 97.0; y_mm += 0.5) {
    const auto rgb = colourAt(picture, {60.0, y_mm});
    ++(rgb[2] > rgb[0] + 60 ? blue : gaps);
  }
  EXPECT_GT(blue, 30);
  EXPECT_GT(gaps, 30);
}

TEST(DrawingPicture, TellsSizePiecesAndLengths) {
  const std::string svg = svgOf(plate(), {.title = "plate.dxf"});
  EXPECT_THAT(svg, HasSubstr("plate.dxf: 100.00 x 100.00 mm, 2 outlines, 1 hole<"));
  // 400 mm of sides, 2 pi 20 and 2 pi 5 of circles.
  EXPECT_THAT(svg, HasSubstr("cut, layer cut: 6 lines, 557.1 mm"));
  EXPECT_THAT(svg, HasSubstr("crease, layer fold: 1 line, 100.0 mm"));
}

TEST(DrawingPicture, NumbersOfTheScaleStandApartAndAreRight) {
  for (const double side_mm : {0.5, 3.0, 47.0, 210.0, 990.0, 20'000.0}) {
    dieline::Dieline dieline;
    addLine(dieline, Process::kCut, "cut", {0, 0}, {side_mm, 0});
    addLine(dieline, Process::kCut, "cut", {side_mm, 0}, {side_mm, 0.7 * side_mm});
    pugi::xml_document page;
    ASSERT_TRUE(page.load_string(svgOf(dieline, {.title = "l"}).c_str()));
    std::vector<double> at_px;
    std::vector<double> value_mm;
    for (const auto& text : page.child("svg").children("text")) {
      if (std::string(text.attribute("text-anchor").value()) != "middle") continue;
      at_px.push_back(text.attribute("x").as_double());
      value_mm.push_back(text.text().as_double());
    }
    ASSERT_GE(at_px.size(), 4U) << side_mm;
    const double px_per_mm = std::min(1072.0 / std::max(1.0, side_mm), 1072.0 / std::max(1.0, 0.7 * side_mm));
    for (std::size_t i = 1; i < at_px.size(); ++i) {
      EXPECT_GE(at_px[i] - at_px[i - 1], 60.0 - 0.02) << side_mm;
      EXPECT_NEAR(at_px[i] - at_px[i - 1], px_per_mm * (value_mm[i] - value_mm[i - 1]), 0.02) << side_mm;
    }
  }
}

TEST(DrawingPicture, MarksErrorsFirstAndCountsTheRest) {
  PictureContent content{.title = "plate.dxf"};
  for (int i = 0; i < 30; ++i) {
    content.findings.push_back({dieline::LintFinding::Kind::kGap,
                                i == 29,
                                {3.0 * i, 50.0},
                                "cut",
                                i == 29 ? "the worst <one>" : "a small one"});
  }
  content.notes = {"3 TEXT are ignored"};
  const std::string svg = svgOf(plate(), content);
  EXPECT_THAT(svg, HasSubstr("error: the worst &lt;one&gt;<"));
  EXPECT_LT(svg.find("the worst"), svg.find("a small one"));
  EXPECT_THAT(svg, HasSubstr("and 10 more, marked without a number"));
  EXPECT_THAT(svg, HasSubstr("3 TEXT are ignored"));
  pugi::xml_document page;
  ASSERT_TRUE(page.load_string(svg.c_str()));
  const auto marks = page.child("svg").children("circle");
  // 30 places and 20 rows with a number.
  EXPECT_EQ(std::distance(marks.begin(), marks.end()), 50);
}

TEST(DrawingPicture, WhatIsAcceptedIsNoError) {
  dieline::Dieline dieline = plate();
  addLine(dieline, Process::kCrease, "fold", {60, 0}, {60, 100});
  using Kind = dieline::LintFinding::Kind;
  const std::string as_it_is = svgOf(dieline, contentOf(dieline, "plate", 800, {}));
  EXPECT_THAT(as_it_is, HasSubstr("error: "));
  const std::string accepted = svgOf(dieline, contentOf(dieline, "plate", 800, {Kind::kDuplicate}));
  EXPECT_THAT(accepted, Not(HasSubstr("error: ")));
  EXPECT_THAT(accepted, HasSubstr("warning: "));
}

TEST(DrawingPicture, NamesOfLayersDoNothingInTheSvg) {
  dieline::Dieline dieline = plate();
  dieline.entities[0].layer = "<script>alert(1)</script>\x1b[31m";
  const std::string svg = svgOf(dieline, {.title = "a<b>&.dxf"});
  EXPECT_THAT(svg, Not(HasSubstr("<script>")));
  EXPECT_THAT(svg, Not(HasSubstr("\x1b")));
  pugi::xml_document page;
  EXPECT_TRUE(page.load_string(svg.c_str()));
}

TEST(DrawingPicture, ShowsADotAndALine) {
  dieline::Dieline dot;
  addLine(dot, Process::kCut, "cut", {5, 5}, {5, 5});
  EXPECT_THAT(svgOf(dot, {.title = "dot"}), HasSubstr("</svg>"));
  dieline::Dieline line;
  addLine(line, Process::kCut, "cut", {5, 5}, {905, 5});
  EXPECT_LT(decoded(line, {.title = "line"}).height_px, 400);
}

TEST(DrawingPicture, RefusesWhatCannotBeShown) {
  EXPECT_THROW(svgOf({}, {.title = "nothing"}), std::invalid_argument);
  EXPECT_THROW(svgOf(plate(), {.title = "narrow", .width_px = 399}), std::invalid_argument);
  dieline::Dieline far = plate();
  addLine(far, Process::kCut, "cut", {0, 0}, {std::numeric_limits<double>::infinity(), 0});
  EXPECT_THROW(svgOf(far, {.title = "far"}), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::drawing
