// SPDX-License-Identifier: Apache-2.0
#include "hil/diagnose/gate_fit.h"

#include <gtest/gtest.h>

#include <optional>
#include <utility>

namespace kerfbench::diagnose {
namespace {

constexpr double kSlideStep_mm = 0.004;
constexpr double kNear_mm = 0.5;
constexpr double kSheet_mm = 3.0;

std::optional<Eigen::Vector2d> onSlides(const Eigen::Vector2d& steps) { return kSlideStep_mm * steps; }

/// Two lines 30 mm apart.
dieline::Dieline twoLines() {
  dieline::Dieline dieline;
  for (const double y : {0.0, 30.0}) {
    dieline::Entity entity;
    entity.curve = dieline::LineCurve{{5.0, y}, {45.0, y}};
    dieline.entities.push_back(entity);
  }
  return dieline;
}

std::vector<LitInstant> wayOf(const Eigen::Vector2d& from, const Eigen::Vector2d& to, int instants) {
  std::vector<LitInstant> way;
  for (int i = 0; i < instants; ++i) {
    const Eigen::Vector2d p_S = from + (i + 0.5) / instants * (to - from);
    way.push_back({(p_S + Eigen::Vector2d(kSheet_mm, 0.0)) / kSlideStep_mm, kSheet_mm});
  }
  return way;
}

std::vector<LitInstant> joined(std::vector<LitInstant> one, const std::vector<LitInstant>& other) {
  one.insert(one.end(), other.begin(), other.end());
  return one;
}

bool isInverted(const GatedPath& path) {
  return isGateInverted(path, onSlides, twoLines(), {.units = 1, .pitch_mm = 100}, kNear_mm);
}

const std::vector<LitInstant> kCuts = joined(wayOf({5, 0}, {45, 0}, 50), wayOf({45, 30}, {5, 30}, 50));
const std::vector<LitInstant> kJump = wayOf({45, 0}, {45, 30}, 40);

TEST(GateFit, AGateThatIsOpenInTheCutsIsNot) { EXPECT_FALSE(isInverted({.open = kCuts, .closed = kJump})); }

TEST(GateFit, AGateThatIsOpenBetweenTheCutsAndClosedInThemIs) {
  EXPECT_TRUE(isInverted({.open = kJump, .closed = kCuts}));
}

TEST(GateFit, ACutThatIsLeftOutIsNoInvertedGate) {
  EXPECT_FALSE(isInverted(
      {.open = wayOf({5, 0}, {45, 0}, 50), .closed = joined(kJump, wayOf({45, 30}, {5, 30}, 50))}));
}

TEST(GateFit, AGateThatNeverClosesIsNone) {
  EXPECT_FALSE(isInverted({.open = joined(kCuts, kJump), .closed = {}}));
  EXPECT_FALSE(isInverted({.open = joined(kCuts, kJump), .closed = wayOf({5, 0}, {10, 0}, 30)}));
}

TEST(GateFit, APathBesideTheDrawingTellsNothing) {
  EXPECT_FALSE(isInverted({.open = wayOf({5, 12}, {45, 12}, 50), .closed = wayOf({5, 15}, {45, 15}, 50)}));
}

TEST(GateFit, FewInstantsTellNothing) {
  EXPECT_FALSE(isInverted({.open = wayOf({45, 0}, {45, 30}, 19), .closed = kCuts}));
}

}  // namespace
}  // namespace kerfbench::diagnose
