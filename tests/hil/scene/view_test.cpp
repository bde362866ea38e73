// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace kerfbench::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const std::vector<Vector3d> kPoints{{-300, -100, -50}, {400, 120, 0}, {0, 0, 600}, {-200, 90, 300}};

TEST(Viewpoint, AllPointsAreWithinThePictureAndSomeTouchItsRim) {
  for (const Vector2d& size : {Vector2d(640, 400), Vector2d(300, 900)}) {
    const auto width = static_cast<int>(size.x());
    const auto height = static_cast<int>(size.y());
    const Viewpoint view = Viewpoint::around(kPoints, {-0.5, 1.0, -0.6}, width, height, 0.9);
    double fullest = 0.0;
    for (const Vector3d& point : kPoints) {
      const auto p = view.project(point);
      ASSERT_TRUE(p);
      const Vector2d of_half = (*p - 0.5 * (size - Vector2d(1, 1))).cwiseQuotient(0.5 * size).cwiseAbs();
      EXPECT_LE(of_half.maxCoeff(), 0.9 + 1e-9);
      fullest = std::max(fullest, of_half.maxCoeff());
    }
    EXPECT_NEAR(fullest, 0.9, 1e-9);
  }
}

TEST(Viewpoint, TheRightOfThePictureCanBeKeptFree) {
  const Viewpoint view = Viewpoint::around(kPoints, {-0.5, 1.0, -0.6}, 400, 400, 1.0, 0.25);
  double right_px = 0.0;
  for (const Vector3d& point : kPoints) {
    right_px = std::max(right_px, view.project(point)->x());
    EXPECT_GE(view.project(point)->x(), -0.5 - 1e-9);
  }
  EXPECT_LE(right_px, 0.75 * 400 - 0.5 + 1e-9);
}

TEST(Viewpoint, ThePictureIsUprightAndNotMirrored) {
  const Viewpoint view = Viewpoint::around(kPoints, Vector3d(0.0, 1.0, -0.4), 640, 400);
  const Vector2d origin = *view.project({0, 0, 0});
  EXPECT_GT(view.project({50, 0, 0})->x(), origin.x());
  EXPECT_LT(view.project({0, 0, 50})->y(), origin.y());
  EXPECT_LT(view.project({0, 50, 0})->y(), origin.y()) << "what is farther on the floor appears higher";
}

TEST(Viewpoint, APixelSpansWhatTheProjectionSays) {
  const Viewpoint view = Viewpoint::around(kPoints, {-0.5, 1.0, -0.6}, 640, 400);
  const Vector3d p(20, 30, 0);
  const double px = view.pixel_mm(p);
  EXPECT_NEAR((*view.project(p + px * view.right()) - *view.project(p)).x(), 1.0, 1e-9);
}

TEST(Viewpoint, WhatIsBehindIsNotSeen) {
  const Viewpoint view = Viewpoint::around(kPoints, {0.0, 1.0, -0.4}, 640, 400);
  EXPECT_FALSE(view.project(view.place_mm() - view.forward()));
}

TEST(Viewpoint, FromAPlaceAllPointsAreWithinTheShareAndOneTouchesIt) {
  const Vector3d place(900, -1200, 1500);
  const Viewpoint view = Viewpoint::from(place, kPoints, 500, 0.8);
  EXPECT_EQ(view.place_mm(), place);
  double fullest = 0.0;
  for (const Vector3d& point : kPoints) {
    const auto p = view.project(point);
    ASSERT_TRUE(p);
    fullest = std::max(fullest, ((*p - Vector2d(249.5, 249.5)) / 250.0).cwiseAbs().maxCoeff());
  }
  EXPECT_NEAR(fullest, 0.8, 1e-9);
}

TEST(Viewpoint, FromAPlaceRefusesWhatItCannotSee) {
  const Vector3d place(900, -1200, 1500);
  EXPECT_THROW(Viewpoint::from(place, {}, 500, 0.8), std::invalid_argument);
  EXPECT_THROW(Viewpoint::from(place, {place - Vector3d(0, 0, 10)}, 500, 0.8), std::invalid_argument);
  EXPECT_THROW(Viewpoint::from(place, {kPoints[0]}, 500, 0.8), std::invalid_argument);
  EXPECT_THROW(Viewpoint::from(place, {kPoints[0], 2.0 * place}, 500, 0.8), std::invalid_argument);
  EXPECT_THROW(Viewpoint::from(place, kPoints, 0, 0.8), std::invalid_argument);
  EXPECT_THROW(Viewpoint::from(place, kPoints, 500, 1.1), std::invalid_argument);
}

TEST(Viewpoint, RefusesNothingToLookAt) {
  EXPECT_THROW(Viewpoint::around({}, {0, 1, 0}, 640, 400), std::invalid_argument);
  EXPECT_THROW(Viewpoint::around(kPoints, {0, 0, -1}, 640, 400), std::invalid_argument);
  EXPECT_THROW(Viewpoint::around(kPoints, {0, 1, 0}, 0, 400), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::scene
