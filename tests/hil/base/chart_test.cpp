// SPDX-License-Identifier: Apache-2.0
#include "hil/base/chart.h"

#include <cmath>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::base {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Chart, DrawsEachStrokeByItsScales) {
  const std::string svg = svgOf({"Way & <where>",
                                 "x, mm",
                                 "y, mm",
                                 {{"cut", {{{0.0, 0.0}, {10.0, 0.0}}, {{10.0, 5.0}, {0.0, 5.0}}}, true}},
                                 false});
  EXPECT_THAT(svg, HasSubstr("Way &amp; &lt;where&gt;"));
  EXPECT_THAT(svg, HasSubstr(">cut</text>"));
  // The values take all but 4 % of the frame at each end: 560 px from 72 on, 320 px from 34 on.
  EXPECT_THAT(svg, HasSubstr("M 92.74 342.15 L 611.26 342.15M 611.26 45.85 L 92.74 45.85"));
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray"));
  EXPECT_THAT(svg, HasSubstr("text-anchor='middle'>10</text>"));
}

TEST(Chart, HasScalesByPowersOfTen) {
  const std::string svg = svgOf({"", "", "", {{"", {{{1.0, 10.0}, {10000.0, 1e5}}}, false}}, true});
  for (const char* tick : {">1<", ">100<", ">10000<", ">100000<"}) EXPECT_THAT(svg, HasSubstr(tick));
  EXPECT_THAT(svg, Not(HasSubstr(">2000<")));
}

TEST(Chart, HasOneScaleForPlaces) {
  // 10 x 10 mm in a frame of 560 x 320 px: 320 / 10.8 px for a mm, about the middle of the frame.
  const std::string svg = svgOf({"", "", "", {{"", {{{0.0, 0.0}, {10.0, 10.0}}}, false}}, false, true});
  EXPECT_THAT(svg, HasSubstr("M 203.85 342.15 L 500.15 45.85"));
}

TEST(Chart, RefusesWhatNoScaleHolds) {
  EXPECT_THROW(svgOf({}), std::invalid_argument);
  EXPECT_THROW(svgOf({"", "", "", {{"", {{{1.0, std::nan("")}}}, false}}, false}), std::invalid_argument);
  EXPECT_THROW(svgOf({"", "", "", {{"", {{{0.0, 1.0}}}, false}}, true}), std::invalid_argument);
}

TEST(Chart, ShowsAnEvenCurve) {
  EXPECT_THAT(svgOf({"", "", "", {{"", {{{0.0, 3.0}, {1.0, 3.0}}}, false}}, false}), HasSubstr(">3<"));
}

}  // namespace
}  // namespace kerfbench::base
