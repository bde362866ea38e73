// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/bundle.h"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/Cholesky>

#include "tests/hil/calibrate/small_camera.h"
#include "twin/base/random.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Isometry3d moved(const Isometry3d& X, const Eigen::Matrix<double, 6, 1>& by) {
  Isometry3d out = X;
  const Vector3d turn = by.head<3>();
  if (turn.norm() > 0.0)
    out.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix() * X.linear();
  out.translation() += by.tail<3>();
  return out;
}

TEST(Bundle, SlopesAreThoseOfFiniteDifferences) {
  const twin::CameraDescription camera = test::smallCamera();
  const BundleLens lens{{camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px},
                        {-0.2, 0.1, 2e-3, -3e-3, 0.3}};
  const Isometry3d X = camera::twinViews(camera, camera::targetOf(camera), 3).X_CB.at(2);
  const Vector2d p_mm(7.0, 31.0);
  ProjectionSlopes by;
  (void)project(lens, X, p_mm, by);
  for (int i = 0; i < 15; ++i) {
    const double h = i < 4 ? 1e-3 : i < 12 ? 1e-6 : 1e-4;
    const auto at = [&](double step) {
      BundleLens other = lens;
      Eigen::Matrix<double, 6, 1> pose = Eigen::Matrix<double, 6, 1>::Zero();
      if (i < 4) other.pinhole[i] += step;
      if (i >= 4 && i < 9) other.distortion.at(static_cast<std::size_t>(i - 4)) += step;
      if (i >= 9) pose[i - 9] = step;
      return project(other, moved(X, pose), p_mm);
    };
    const Vector2d slope = (at(h) - at(-h)) / (2.0 * h);
    EXPECT_LT((slope - by.col(i)).norm(), 1e-5 * (1.0 + slope.norm())) << i;
  }
}

/// Corners of the small camera's views, each displaced by a normal sample. The first view is the noisier.
Bundle drawnBundle(std::uint64_t seed) {
  const twin::CameraDescription camera = test::smallCamera();
  const CalibrationTarget target = camera::targetOf(camera);
  Bundle bundle;
  bundle.lens = {{camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}, camera.distortion};
  bundle.X_CB = camera::twinViews(camera, target, 5).X_CB;
  for (std::size_t v = 0; v < bundle.X_CB.size(); ++v) {
    const CounterRandom random(seed, v);
    const double sigma_px = v == 0 ? 0.02 : 0.005;
    std::uint64_t n = 0;
    bundle.points.emplace_back();
    for (int row = 1; row < target.rows; ++row) {
      for (int column = 1; column < target.columns; ++column) {
        const Vector2d p_mm = target.square_mm * Vector2d(column, row);
        const Vector2d noise(random.normal(2 * n), random.normal(2 * n + 1));
        ++n;
        bundle.points.back().push_back({p_mm, project(bundle.lens, bundle.X_CB[v], p_mm) + sigma_px * noise});
      }
    }
  }
  return bundle;
}

TEST(Bundle, FindsWhatTheCornersWereMadeFrom) {
  Bundle bundle = drawnBundle(1);
  for (std::size_t v = 0; v < bundle.points.size(); ++v) {
    for (BundlePoint& point : bundle.points[v])
      point.pixel = project(bundle.lens, bundle.X_CB[v], point.p_B_mm);
  }
  const Bundle truth = bundle;
  bundle.lens.pinhole += Eigen::Vector4d(60.0, -40.0, 9.0, 12.0);
  bundle.lens.distortion = {};
  for (Isometry3d& X : bundle.X_CB)
    X = moved(X, (Eigen::Matrix<double, 6, 1>() << 0.02, -0.01, 0.03, 1, -2, 6).finished());
  const BundleResult result = adjust(bundle);
  EXPECT_TRUE(result.settled);
  EXPECT_LT(result.rms_px, 1e-7);
  EXPECT_LT((result.lens.pinhole - truth.lens.pinhole).norm(), 1e-4);
}

TEST(Bundle, ItsCovarianceIsThatOfRepeatedDraws) {
  constexpr int kDraws = 200;
  const Bundle truth = drawnBundle(0);
  double chi2 = 0.0;
  double reduced = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const BundleResult result = adjust(drawnBundle(static_cast<std::uint64_t>(draw + 1)));
    Eigen::Matrix<double, 15, 1> miss;
    miss.head<4>() = result.lens.pinhole - truth.lens.pinhole;
    for (Eigen::Index i = 0; i < 5; ++i) {
      const auto k = static_cast<std::size_t>(i);
      miss[4 + i] = result.lens.distortion.at(k) - truth.lens.distortion.at(k);
    }
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(result.X_CB[0].linear() * truth.X_CB[0].linear().transpose()));
    miss.segment<3>(9) = turn.angle() * turn.axis();
    miss.tail<3>() = result.X_CB[0].translation() - truth.X_CB[0].translation();
    const Eigen::Matrix<double, 15, 15> covariance = result.covariance.topLeftCorner<15, 15>();
    const Eigen::Matrix<double, 15, 1> sigma = covariance.diagonal().cwiseSqrt();
    const Eigen::Matrix<double, 15, 15> even =
        sigma.cwiseInverse().asDiagonal() * covariance * sigma.cwiseInverse().asDiagonal();
    const Eigen::Matrix<double, 15, 1> z = miss.cwiseQuotient(sigma);
    chi2 += z.dot(even.ldlt().solve(z));
    reduced += result.sigma_px[0] / (0.02 * kDraws);
  }
  // 15 x 200 degrees of freedom: 1 ± 0.026 (one sigma); 3.3 sigmas, and 2 % for scatter that is estimated.
  EXPECT_NEAR(chi2 / (15.0 * kDraws), 1.0, 0.105);
  EXPECT_NEAR(reduced, 1.0, 0.02);
}

TEST(Bundle, RefusesWhatCannotBeAdjusted) {
  EXPECT_THROW((void)adjust({}), std::invalid_argument);
  Bundle bundle = drawnBundle(1);
  bundle.X_CB.pop_back();
  EXPECT_THROW((void)adjust(bundle), std::invalid_argument);
  bundle = drawnBundle(1);
  bundle.points[1].resize(3);
  EXPECT_THROW((void)adjust(bundle), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::calibrate
