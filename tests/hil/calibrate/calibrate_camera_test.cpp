// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/calibrate_camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/QR>

#include "hil/base/parallel.h"
#include "hil/calibrate/camera/residual_map.h"
#include "tests/hil/calibrate/small_camera.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

TEST(CalibrateCamera, FindsTheMapOfACameraThatItHasNotBeenTold) {
  const CameraCalibrationResult result = calibrateCamera(test::smallJob(1));
  const vision::CameraCalibration& c = result.calibration;
  // The limit is a hundredth of a pixel, at 0.1 mm/px.
  EXPECT_LT(test::largest(test::mapErrors(c, test::truthOf(test::smallCamera()), 20)), 0.001);
  EXPECT_LT(c.rms_px, 0.006);
  EXPECT_LT(c.map_u_mm, 0.0005);
  EXPECT_GT(c.map_u_mm, 1e-5);
  EXPECT_EQ(result.outliers, 0U);
  EXPECT_EQ(result.views.size(), 6U);
  EXPECT_EQ(c.camera_id, "small");
  EXPECT_EQ(c.date, "2026-11-20");
  // The camera's field is 56 x 44 mm.
  EXPECT_GT(c.area_mm.sizes().x(), 48.0);
  EXPECT_GT(c.area_mm.sizes().y(), 36.0);
  EXPECT_NEAR(result.views.at(1).tilt_rad, 0.52, 0.1);
  const std::string svg = residualMapSvg(result);
  EXPECT_NE(svg.find("view 5"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

/// Views by a telecentric lens; without distortion nothing tells where its axis is.
class TelecentricCamera : public testing::TestWithParam<bool> {};

TEST_P(TelecentricCamera, IsCalibratedFromTheSameViews) {
  twin::CameraDescription camera = test::smallCamera();
  camera.telecentric_mm = 250.0;
  if (!GetParam()) camera.distortion = {};
  // Half a degree from square.
  camera.X_CP.linear() = (Eigen::AngleAxisd(0.0087, Eigen::Vector3d::UnitX()) *
                          Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
                             .toRotationMatrix();
  CalibrationJob job = test::smallJob(1);
  camera::setTwinViews(camera, camera::twinViews(camera, job.target, 5), 1, job);
  const vision::CameraCalibration c = calibrateCamera(job).calibration;
  EXPECT_EQ(c.telecentric_mm, 250.0);
  const double most_mm = test::largest(test::mapErrors(c, test::truthOf(camera), 20));
  EXPECT_LT(most_mm, 0.0015);
  EXPECT_LT(most_mm, 4.0 * c.map_u_mm);
  EXPECT_LT(c.rms_px, 0.006);
  EXPECT_GT(c.square_within_rad, 0.0087);
  EXPECT_LT(c.square_within_rad, 0.02);
}
INSTANTIATE_TEST_SUITE_P(Distortion, TelecentricCamera, testing::Bool());

TEST(CalibrateCamera, IsTheSameAtAnyNumberOfThreads) {
  CalibrationJob job = test::smallJob(2, 3);
  const vision::CameraCalibration one = calibrateCamera(job).calibration;
  job.threads = 3;
  const vision::CameraCalibration three = calibrateCamera(job).calibration;
  EXPECT_EQ(one.fx_px, three.fx_px);
  EXPECT_EQ(one.distortion, three.distortion);
  EXPECT_EQ(one.X_CP.matrix(), three.X_CP.matrix());
  EXPECT_EQ(one.error_modes, three.error_modes);
}

TEST(CalibrateCamera, ItsModesAreItsUncertainty) {
  const vision::CameraCalibration c = calibrateCamera(test::smallJob(3)).calibration;
  double most_mm = 0.0;
  std::vector<Vector2d> places_mm;
  (void)test::mapErrors(c, c, 20, &places_mm);
  for (const Vector2d& p_mm : places_mm) {
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (std::size_t k = 0; k < c.error_modes.size(); ++k)
      spread += c.mapError(k, p_mm) * c.mapError(k, p_mm).transpose();
    const double half = 0.5 * (spread(0, 0) - spread(1, 1));
    most_mm = std::max(most_mm, std::sqrt(0.5 * spread.trace() + std::hypot(half, spread(0, 1))));
  }
  EXPECT_NEAR(most_mm / c.map_u_mm, 1.0, 0.01);
}

// The stated covariance is compared with the scatter of calibrations by 30 seeds, from rendered pictures.
TEST(CalibrateCamera, ItsCovarianceIsHonest) {
  constexpr std::size_t kSeeds = 30;
  // The strongest modes; the others move no point by a fiftieth of the first.
  constexpr std::size_t kModes = 8;
  const vision::CameraCalibration truth = test::truthOf(test::smallCamera());
  struct Sums {
    double misses_mm2{}, stated_mm2{}, chi2{};
  };
  std::vector<Sums> of_seed(kSeeds);
  base::forEachIndex(kSeeds, 4, [&](std::size_t seed) {
    const vision::CameraCalibration c = calibrateCamera(test::smallJob(100 + seed, 4)).calibration;
    std::vector<Vector2d> places_mm;
    const std::vector<Vector2d> misses_mm = test::mapErrors(c, truth, 8, &places_mm);
    Eigen::VectorXd seen(2 * static_cast<Eigen::Index>(misses_mm.size()));
    Eigen::MatrixXd modes(seen.size(), static_cast<Eigen::Index>(c.error_modes.size()));
    for (std::size_t i = 0; i < misses_mm.size(); ++i) {
      const auto row = 2 * static_cast<Eigen::Index>(i);
      seen.segment<2>(row) = misses_mm[i];
      for (std::size_t k = 0; k < c.error_modes.size(); ++k)
        modes.block<2, 1>(row, static_cast<Eigen::Index>(k)) = c.mapError(k, places_mm[i]);
    }
    // Amount of each mode: standard normal, if the covariance is right.
    const Eigen::VectorXd share = modes.colPivHouseholderQr().solve(seen);
    of_seed[seed] = {seen.squaredNorm(), modes.squaredNorm(), share.head(kModes).squaredNorm()};
  });
  Sums all;
  for (const Sums& sums : of_seed) {
    all.misses_mm2 += sums.misses_mm2;
    all.stated_mm2 += sums.stated_mm2;
    all.chi2 += sums.chi2;
  }
  const double modes_over_stated = std::sqrt(all.chi2 / (kSeeds * static_cast<double>(kModes)));
  const double spread_over_stated = std::sqrt(all.misses_mm2 / all.stated_mm2);
  RecordProperty("modes_over_stated", std::to_string(modes_over_stated));
  RecordProperty("spread_over_stated", std::to_string(spread_over_stated));
  // The limit is 3.3 sigma: for 240 degrees of freedom chi2 / 240 has a square root of 1 ± 0.046.
  EXPECT_NEAR(modes_over_stated, 1.0, 0.15);
  // The first modes dominate the sum: some 100 degrees of freedom, 0.07.
  EXPECT_NEAR(spread_over_stated, 1.0, 0.23);
}

}  // namespace
}  // namespace kerfbench::calibrate
