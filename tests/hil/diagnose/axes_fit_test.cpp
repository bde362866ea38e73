// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/axes_fit.h"

#include <cmath>
#include <random>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kerfbench::diagnose {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr double kStep_mm = 0.004;
const std::array<AxisNames, 2> kNames{{{"gantry_x", "step_mm"}, {"gantry_y", "step_mm"}}};

std::optional<Eigen::Vector2d> slides(const Eigen::Vector2d& steps) { return kStep_mm * steps; }

/// A polygon as lines.
dieline::Dieline drawingOf(const std::vector<Eigen::Vector2d>& corners) {
  dieline::Dieline dieline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    dieline::Entity entity;
    entity.id = static_cast<int>(i);
    entity.curve = dieline::LineCurve{corners[i], corners[(i + 1) % corners.size()]};
    dieline.entities.push_back(entity);
  }
  return dieline;
}

/// No turn, mirror or swap maps it on itself.
dieline::Dieline crooked() { return drawingOf({{5, -10}, {45, -10}, {45, 22}, {20, 25}, {5, 15}}); }

using Spoil = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

/// Path along the drawing in whole steps that a firmware has spoiled; units as on a web at rest.
std::vector<LitInstant> pathAlong(const dieline::Dieline& dieline, const Spoil& spoil,
                                  const PrintLayout& print, double sheet_x_mm = 3.0) {
  std::vector<LitInstant> path;
  for (int unit = 0; unit < print.units; ++unit) {
    for (const dieline::Entity& entity : dieline.entities) {
      for (const double u : dieline::stations(entity.curve, 1.3)) {
        const Eigen::Vector2d p_W =
            dieline::pointAt(entity.curve, u) + Eigen::Vector2d(sheet_x_mm - unit * print.pitch_mm, 0.0);
        const Eigen::Vector2d steps = spoil(p_W / kStep_mm);
        path.push_back({Eigen::Vector2d(std::round(steps.x()), std::round(steps.y())), sheet_x_mm});
      }
    }
  }
  return path;
}

std::optional<AxesFit> fitOf(const Spoil& spoil, const dieline::Dieline& dieline = crooked(),
                             const PrintLayout& print = {.units = 1, .pitch_mm = 100}) {
  return fitAxes(pathAlong(dieline, spoil, print), slides, dieline, print, {.worth_mm = 0.02});
}

TEST(AxesFit, AGoodPathHasNoCause) {
  EXPECT_FALSE(fitOf([](const Eigen::Vector2d& s) { return s; }));
}

TEST(AxesFit, AnAxisThatRunsBackwardsIsNamed) {
  const auto x = fitOf([](const Eigen::Vector2d& s) { return Eigen::Vector2d(-s.x(), s.y()); });
  ASSERT_TRUE(x);
  EXPECT_FALSE(x->swapped);
  EXPECT_EQ(x->factor, Eigen::Vector2d(-1, 1));
  EXPECT_GT(x->before_mm, 5.0);
  EXPECT_LT(x->after_mm, 0.005);
  EXPECT_EQ(
      sentenceOf(*x, kNames),
      "X runs backwards: invert DIR of gantry_x in the firmware (Grbl: $3), or set `gantry_x.dir_low` if the "
      "drive takes DIR low for forwards.");
  const auto both = fitOf([](const Eigen::Vector2d& s) { return Eigen::Vector2d(-s); });
  ASSERT_TRUE(both);
  EXPECT_THAT(sentenceOf(*both, kNames), AllOf(HasSubstr("X runs backwards"), HasSubstr("Y runs backwards")));
}

TEST(AxesFit, SwappedAxesAreNamedAndWhatElseIsWrongWithThem) {
  const auto swapped = fitOf([](const Eigen::Vector2d& s) { return Eigen::Vector2d(s.y(), s.x()); });
  ASSERT_TRUE(swapped);
  EXPECT_TRUE(swapped->swapped);
  EXPECT_EQ(swapped->factor, Eigen::Vector2d(1, 1));
  EXPECT_THAT(sentenceOf(*swapped, kNames),
              AllOf(HasSubstr("X and Y are swapped"), Not(HasSubstr("backwards"))));
  const auto turned = fitOf([](const Eigen::Vector2d& s) { return Eigen::Vector2d(-s.y(), s.x()); });
  ASSERT_TRUE(turned);
  EXPECT_TRUE(turned->swapped);
  EXPECT_EQ(turned->factor, Eigen::Vector2d(1, -1));
}

TEST(AxesFit, AScaleIsMeasured) {
  for (const double factor : {1.002, 0.998, 1.05, 0.32, 3.125}) {
    const auto fit = fitOf([&](const Eigen::Vector2d& s) { return Eigen::Vector2d(factor * s.x(), s.y()); });
    ASSERT_TRUE(fit) << factor;
    EXPECT_NEAR(fit->factor.x(), factor, std::max(fit->u_factor.x(), 1e-5 * factor)) << factor;
    EXPECT_LT(fit->u_factor.x(), 2e-4 * factor);
    EXPECT_NEAR(fit->factor.y(), 1.0, fit->u_factor.y()) << factor;
    EXPECT_THAT(sentenceOf(*fit, kNames), AllOf(HasSubstr(factor > 1 ? "too far" : "too little"),
                                                HasSubstr("$100"), Not(HasSubstr("Y moves"))));
  }
}

TEST(AxesFit, BackwardsAndOfAnotherScaleAreSaidTogether) {
  const auto fit = fitOf([](const Eigen::Vector2d& s) { return Eigen::Vector2d(s.x(), -1.25 * s.y()); });
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->factor.y(), -1.25, 1e-3);
  EXPECT_THAT(sentenceOf(*fit, kNames), AllOf(HasSubstr("Y runs backwards"), HasSubstr("Y moves 25.0")));
}

TEST(AxesFit, EachUnitOfAWebIsHeldAgainstTheSameDrawing) {
  const PrintLayout web{.units = 3, .pitch_mm = 60};
  EXPECT_FALSE(fitOf([](const Eigen::Vector2d& s) { return s; }, crooked(), web));
  const auto y =
      fitOf([](const Eigen::Vector2d& s) { return Eigen::Vector2d(s.x(), -s.y()); }, crooked(), web);
  ASSERT_TRUE(y);
  EXPECT_EQ(y->factor, Eigen::Vector2d(1, -1));
}

TEST(AxesFit, WhatADrawingCannotTellApartIsNotNamed) {
  // Turned by half a turn about the middle of its axes a square is the same: X backwards, or Y with another
  // drawing of the same place, would be a guess.
  const dieline::Dieline square = drawingOf({{-20, -20}, {20, -20}, {20, 20}, {-20, 20}});
  const PrintLayout print{.units = 1, .pitch_mm = 100};
  const auto shifted = [](const Eigen::Vector2d& s) {
    return Eigen::Vector2d(-s.x() + 30.0 / kStep_mm, s.y());
  };
  EXPECT_FALSE(fitAxes(pathAlong(square, shifted, print, 0.0), slides, square, print, {.worth_mm = 0.02}));
}

TEST(AxesFit, OtherFaultsOfAPathAreNoFaultOfTheAxes) {
  std::mt19937 random(7);  // NOLINT(bugprone-random-generator-seed): the same each time
  std::normal_distribution<double> noise(0.0, 40.0);
  EXPECT_FALSE(fitOf([&](const Eigen::Vector2d& s) {
    return Eigen::Vector2d(s.x() + noise(random), s.y() + noise(random));
  }));
  EXPECT_FALSE(fitOf([](const Eigen::Vector2d& s) { return Eigen::Vector2d(s.x() + 500.0, s.y() - 300.0); }));
  // A job that begins somewhere else, as after homing without an offset.
  EXPECT_FALSE(fitOf([](const Eigen::Vector2d& s) {
    return Eigen::Vector2d(s.x() + 750.0 / kStep_mm, s.y() + 400.0 / kStep_mm);
  }));
  // Steps that are lost in the middle.
  int count = 0;
  EXPECT_FALSE(fitOf([&](const Eigen::Vector2d& s) {
    return Eigen::Vector2d(s.x() + (++count > 70 ? 100.0 : 0.0), s.y());
  }));
}

TEST(AxesFit, SwappedByOnePerCentIsLikelierThanAScaleThatIsFarOff) {
  const dieline::Dieline rectangle = drawingOf({{0, 0}, {60, 0}, {60, 40}, {0, 40}});
  const auto fit =
      fitOf([](const Eigen::Vector2d& s) { return Eigen::Vector2d(1.01 * s.y(), 1.01 * s.x()); }, rectangle);
  ASSERT_TRUE(fit);
  EXPECT_TRUE(fit->swapped);
  EXPECT_NEAR(fit->factor.x(), 1.01, 1e-3);
}

TEST(AxesFit, OneLineOfManyProvesNothingOfTheAxes) {
  const dieline::Dieline whole = drawingOf({{0, 5}, {40, 5}, {40, 30}, {0, 30}});
  dieline::Dieline first = whole;
  first.entities.resize(1);
  const PrintLayout print{.units = 1, .pitch_mm = 100};
  const auto shifted = [](const Eigen::Vector2d& s) {
    return Eigen::Vector2d(s.x(), s.y() + 0.5 / kStep_mm);
  };
  EXPECT_FALSE(fitAxes(pathAlong(first, shifted, print), slides, whole, print, {.worth_mm = 0.02}));
  EXPECT_FALSE(fitAxes(pathAlong(first, shifted, print), slides, first, print, {.worth_mm = 0.02}));
}

TEST(AxesFit, AnotherJobIsNotFoldedOntoALineOfTheDrawing) {
  const dieline::Dieline drawing = drawingOf({{0, 0}, {50, 0}, {50, 40}, {0, 40}});
  const dieline::Dieline thin = drawingOf({{0.5, 4}, {2.5, 4}, {2.5, 44}, {0.5, 44}});
  const PrintLayout print{.units = 1, .pitch_mm = 100};
  const auto as_it_is = [](const Eigen::Vector2d& s) { return s; };
  EXPECT_FALSE(fitAxes(pathAlong(thin, as_it_is, print, 0.0), slides, drawing, print, {.worth_mm = 0.02}));
}

TEST(AxesFit, ADrawingOrAPathWithoutWidthIsNoReasonToFail) {
  const dieline::Dieline line = drawingOf({{10, 0}, {10, 40}});
  const PrintLayout print{.units = 1, .pitch_mm = 100};
  for (const double x : {1.0, -1.0, 1.3}) {
    const auto spoil = [&](const Eigen::Vector2d& s) { return Eigen::Vector2d(x * s.x(), 1.02 * s.y()); };
    (void)fitAxes(pathAlong(line, spoil, print), slides, line, print, {.worth_mm = 0.02});
    EXPECT_FALSE(fitAxes(pathAlong(line, spoil, print), slides, crooked(), print, {.worth_mm = 0.02}));
  }
}

TEST(AxesFit, ASheetThatMovesIsNotAskedForAScale) {
  const auto far = [](const Eigen::Vector2d& s) { return Eigen::Vector2d(1.01 * s.x(), s.y()); };
  const PrintLayout print{.units = 1, .pitch_mm = 100};
  const dieline::Dieline dieline = crooked();
  EXPECT_FALSE(fitAxes(pathAlong(dieline, far, print), slides, dieline, print,
                       {.worth_mm = 0.02, .with_scale = false}));
}

TEST(AxesFit, APlaceOutOfReachIsNoPlace) {
  const auto narrow = [](const Eigen::Vector2d& s) -> std::optional<Eigen::Vector2d> {
    const Eigen::Vector2d p = kStep_mm * s;
    return p.x() < 0 ? std::nullopt : std::optional(p);
  };
  const PrintLayout print{.units = 1, .pitch_mm = 100};
  const dieline::Dieline dieline = crooked();
  const auto backwards = [](const Eigen::Vector2d& s) { return Eigen::Vector2d(-s.x(), s.y()); };
  const auto fit = fitAxes(pathAlong(dieline, backwards, print), narrow, dieline, print, {.worth_mm = 0.02});
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->factor, Eigen::Vector2d(-1, 1));
}

}  // namespace
}  // namespace kerfbench::diagnose
