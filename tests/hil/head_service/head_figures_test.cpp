// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/head_figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::head_service {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using testing::HasSubstr;
using testing::Not;

const AlignedBox2d kField(Vector2d(-150.0, -150.0), Vector2d(150.0, 150.0));

TEST(HeadFigures, ErrorsAreDrawnLargerByARoundNumberAndNoLongerThanATwelfthOfTheField) {
  EXPECT_DOUBLE_EQ(exaggerationFor(9.0, kField), 2.0);
  EXPECT_DOUBLE_EQ(exaggerationFor(0.005, kField), 5000.0);
  EXPECT_DOUBLE_EQ(exaggerationFor(0.0051, kField), 2000.0);
  EXPECT_DOUBLE_EQ(exaggerationFor(0.0, kField), 1.0);
}

TEST(HeadFigures, AnArrowGoesFromWhereTheBeamWasWantedUpwardsForAnErrorAlongY) {
  const std::string svg = errorArrows(kField, {{{10.0, 20.0}, {0.0, 0.005}}}, 0.010);
  EXPECT_THAT(svg, HasSubstr("errors × 5000"));
  EXPECT_THAT(svg, HasSubstr("x1=10.000 y1=-20.000 x2=10.000 y2=-45.000"));
  EXPECT_THAT(svg, HasSubstr("<g class=f2>"));  // The error is half of the limit: the third quarter.
  EXPECT_THAT(svg, HasSubstr("off by +0.00, +5.00 µm"));
}

TEST(HeadFigures, TheFieldBeforeBreaksWhereTheBeamDoesNotGet) {
  const auto shifted = [](const Vector2d& p) -> std::optional<Vector2d> {
    if (p.x() > 100.0) return std::nullopt;
    return Vector2d(2.0, 0.0);
  };
  const std::string svg = deformedGrid(kField, shifted, {{{0.0, 0.0}, {2.0, 0.0}}});
  EXPECT_THAT(svg, HasSubstr("errors × 10."));
  EXPECT_THAT(svg, HasSubstr("<path class='drawngrid' d='M-130.000 150.000"));
  EXPECT_THAT(svg, HasSubstr("<circle class=mark cx=20.000 cy=-0.000"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(HeadFigures, OfNoErrorsThereIsNothingToShow) {
  EXPECT_EQ(errorArrows(kField, {}, 0.01), "");
  EXPECT_EQ(errorHistogram({}, 0.01), "");
  EXPECT_EQ(errorScatter({}, 0.01), "");
}

TEST(HeadFigures, WhatIsBeyondTheLimitIsRedInTheHistogram) {
  const std::vector<PlaceError> errors{{{0.0, 0.0}, {0.001, 0.0}}, {{1.0, 0.0}, {0.0, 0.03}}};
  EXPECT_THAT(errorHistogram(errors, 0.010), HasSubstr("class=barbad"));
  EXPECT_THAT(errorHistogram(errors, 0.040), Not(HasSubstr("class=barbad")));
  EXPECT_THAT(errorScatter(errors, 0.010), HasSubstr("Their mean is +0.50, +15.00 µm"));
}

}  // namespace
}  // namespace kerfbench::head_service
