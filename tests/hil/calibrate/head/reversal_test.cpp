// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/reversal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "twin/base/random.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using testing::HasSubstr;

constexpr double kSigma_mm = 0.001;
constexpr double kHalf_mm = 170.0;
const ReversalOptions kOptions{
    .camera_field_mm = {Vector2d::Constant(-kHalf_mm), Vector2d::Constant(kHalf_mm)}};

/// A camera with errors of degree 2 (keystone, decentring) and 3 (radial), by seed.
struct Camera {
  double keystone_x, keystone_y, decentre, radial, scale;
  explicit Camera(std::uint64_t seed) {
    const CounterRandom random(seed, 21);
    const auto draw = [&](std::uint64_t i) { return 0.015 * random.normal(i); };
    keystone_x = draw(0), keystone_y = draw(1), decentre = draw(2), radial = draw(3), scale = draw(4);
  }
  [[nodiscard]] Vector2d even(const Vector2d& p_mm) const {
    const Vector2d u = p_mm / kHalf_mm;
    return u * (keystone_x * u.x() + keystone_y * u.y()) + Vector2d(decentre * u.squaredNorm(), 0.0);
  }
  [[nodiscard]] Vector2d odd(const Vector2d& p_mm) const {
    const Vector2d u = p_mm / kHalf_mm;
    return u * (scale + radial * u.squaredNorm());
  }
  [[nodiscard]] Vector2d error(const Vector2d& p_mm) const { return even(p_mm) + odd(p_mm); }
};

Vector2d placeOf(int id) { return {-140.0 + 35.0 * (id % 9) + 0.03 * id, -140.0 + 35.0 * (id / 9)}; }

SheetView viewOf(const Camera& camera, double turn_deg, const Vector2d& shift_mm, std::uint64_t seed) {
  const CounterRandom random(seed, 22);
  SheetView view{"turned by " + std::to_string(turn_deg), {}};
  const Eigen::Rotation2Dd turn(turn_deg * std::numbers::pi / 180.0);
  for (int id = 0; id < 81; ++id) {
    const auto i = static_cast<std::uint64_t>(id);
    const Vector2d p = turn * placeOf(id) + shift_mm;
    const Vector2d noise = kSigma_mm * Vector2d(random.normal(2 * i), random.normal(2 * i + 1));
    view.marks.push_back({id, p + camera.error(p) + noise, kSigma_mm * kSigma_mm * Matrix2d::Identity()});
  }
  return view;
}

double worst(const ReversalResult& result, const auto& error) {
  double most = 0.0;
  for (const SeenMark& mark : result.marks) most = std::max(most, error(mark).norm());
  return most;
}

TEST(Reversal, TheMeanOfTwoTurnedViewsIsFreeOfErrorsOfEvenDegree) {
  const Camera camera(1);
  const std::vector<SheetView> views{viewOf(camera, 0, {0, 0}, 1), viewOf(camera, 180, {1.5, -0.8}, 2)};
  const auto all = separateCamera(views, kOptions);
  ASSERT_EQ(all.marks.size(), 81U);
  EXPECT_EQ(all.rejected, 0U);
  EXPECT_NEAR(all.noise_ratio, 1.0, 0.25);
  // The remainder on the marks is of odd degree: the camera's odd error, less the guessed part of it.
  const auto left = [&](const SeenMark& mark) -> Vector2d {
    const Vector2d p = placeOf(mark.id);
    const Vector2d guessed = 0.5 * (all.camera.at_mm(p) - all.camera.at_mm(-p));
    return mark.p_mm - p - camera.odd(p) + guessed;
  };
  EXPECT_GT(worst(all, [&](const SeenMark& m) -> Vector2d { return camera.even(placeOf(m.id)); }), 0.02);
  EXPECT_LT(worst(all, left), 0.004);
  for (const CameraError::Term& term : all.camera.terms()) {
    if (term.degree == 2) {
      EXPECT_TRUE(term.held) << term.name;
    } else if (term.degree == 1) {
      EXPECT_FALSE(term.held) << term.name;
      EXPECT_NEAR(term.sigma_mm, kOptions.prior_mm, 0.1 * kOptions.prior_mm) << term.name;
    }
  }
}

TEST(Reversal, AShiftedAndAQuarterTurnedViewTellTheRestButTheScale) {
  const Camera camera(2);
  const std::vector<SheetView> views{viewOf(camera, 0, {0, 0}, 1), viewOf(camera, 180, {2, 3}, 2),
                                     viewOf(camera, 90, {0, -1}, 3), viewOf(camera, 1, {24, 0}, 4),
                                     viewOf(camera, -1, {0, -24}, 5)};
  const auto all = separateCamera(views, kOptions);
  const Vector2d at(120, -90);
  // No view shows a common scale; without it the camera is known.
  const auto shape = [&](const auto& error) -> Vector2d { return error(at) - error(Vector2d(at / 2)) * 2.0; };
  const Vector2d off = shape([&](const Vector2d& p) -> Vector2d { return all.camera.at_mm(p); }) -
                       shape([&](const Vector2d& p) -> Vector2d { return camera.error(p); });
  EXPECT_LT(off.norm(), 0.002);
}

TEST(Reversal, TheStatedUncertaintyCovers) {
  int covered = 0, places = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Camera camera(seed);
    const std::vector<SheetView> views{viewOf(camera, 0, {0, 0}, 2 * seed),
                                       viewOf(camera, 180, {0.5, 0.5}, 2 * seed + 1)};
    const auto all = separateCamera(views, kOptions);
    for (int id = 0; id < 81; id += 5) {
      // The views differ by twice the even part of the error, the part that turns its sign.
      const Vector2d p = placeOf(id);
      const Vector2d even = 0.5 * (all.camera.at_mm(p) + all.camera.at_mm(-p));
      const Vector2d off = even - camera.even(p);
      const Matrix2d covariance = all.camera.covarianceAt_mm2(p);
      covered += off.dot(covariance.inverse() * off) <= 5.991 ? 1 : 0;
      const Vector2d whole = all.camera.at_mm(p) - camera.error(p);
      covered += whole.dot(covariance.inverse() * whole) <= 5.991 ? 1 : 0;
      places += 2;
    }
  }
  EXPECT_GE(covered, 0.94 * places);
}

TEST(Reversal, AMarkThatMovedIsRejected) {
  const Camera camera(3);
  std::vector<SheetView> views{viewOf(camera, 0, {0, 0}, 1), viewOf(camera, 180, {0, 0}, 2)};
  views[1].marks[17].p_mm.x() += 0.02;
  std::swap(views[1].marks[40].p_mm, views[1].marks[41].p_mm);
  const auto all = separateCamera(views, kOptions);
  EXPECT_EQ(all.rejected, 3U);
  for (const SeenMark& mark : all.marks) EXPECT_TRUE(mark.id != 17 && mark.id != 40 && mark.id != 41);
}

TEST(Reversal, OneViewIsItselfAndThePrior) {
  const std::vector<SheetView> views{viewOf(Camera(4), 0, {0, 0}, 1)};
  const auto one = separateCamera(views, kOptions);
  EXPECT_EQ(one.marks[5].p_mm, views[0].marks[5].p_mm);
  for (const CameraError::Term& term : one.camera.terms()) EXPECT_FALSE(term.held);
}

TEST(Reversal, ViewsOfOtherSheetsAreRefused) {
  std::vector<SheetView> views{viewOf(Camera(5), 0, {0, 0}, 1), viewOf(Camera(5), 180, {0, 0}, 2)};
  for (SeenMark& mark : views[1].marks) mark.p_mm *= 0.9;
  views.push_back(views[0]);
  views[2].name = "few";
  views[2].marks.resize(4);
  try {
    separateCamera(views, kOptions);
    FAIL();
  } catch (const HeadCalibrationError& e) {
    EXPECT_THAT(e.what(), HasSubstr("is no turn and shift of"));
    EXPECT_THAT(e.what(), HasSubstr("view 'few' shares 4 marks"));
  }
}

}  // namespace
}  // namespace kerfbench::calibrate
