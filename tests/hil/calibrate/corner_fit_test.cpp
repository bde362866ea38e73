// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/camera/corner_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/calibrate/camera/target_finder.h"
#include "tests/hil/calibrate/small_camera.h"
#include "twin/base/image.h"
#include "twin/camera/target_camera.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

struct Misses {
  double rms_px{}, mean_px{};
  std::size_t corners{};
};

Misses missesOf(const twin::CameraDescription& camera, std::uint64_t seed) {
  const camera::TwinViews views = camera::twinViews(camera, camera::targetOf(camera), 4);
  const twin::TargetCamera eye(camera, camera::boardOf(views.target), seed);
  Misses misses;
  Vector2d mean = Vector2d::Zero();
  for (std::size_t v = 0; v < views.X_CB.size(); ++v) {
    vision::CameraCalibration truth = test::truthOf(camera);
    truth.X_CP = views.X_CB[v];
    for (const TargetCorner& corner : findTarget(eye.render(views.X_CB[v], v), views.target).corners) {
      const Vector2d miss_px =
          corner.pixel - truth.pixelFromPlane(views.target.square_mm * Vector2d(corner.column, corner.row));
      EXPECT_LT(miss_px.norm(), 0.05) << v << ": " << corner.column << " " << corner.row;
      misses.rms_px += 0.5 * miss_px.squaredNorm();
      mean += miss_px;
      ++misses.corners;
    }
  }
  misses.rms_px = std::sqrt(misses.rms_px / static_cast<double>(misses.corners));
  misses.mean_px = mean.norm() / static_cast<double>(misses.corners);
  return misses;
}

TEST(CornerFit, HasNoBiasFromPlaceOrAngle) {
  twin::CameraDescription camera = test::smallCamera();
  camera.bits = 12;
  camera.read_noise = 0.0;
  camera.full_well_electrons = std::numeric_limits<double>::infinity();
  const Misses misses = missesOf(camera, 1);
  EXPECT_GT(misses.corners, 300U);
  EXPECT_LT(misses.rms_px, 2e-4);
  EXPECT_LT(misses.mean_px, 5e-5);
}

TEST(CornerFit, ReachesTheNoiseOfTheCamera) {
  const Misses misses = missesOf(test::smallCamera(), 2);
  EXPECT_LT(misses.rms_px, 0.006);
  EXPECT_LT(misses.mean_px, 0.001);
}

TEST(CornerFit, TakesUnevenLightAndHotPixels) {
  twin::CameraDescription camera = test::smallCamera();
  camera.light = {0.3, 0.2, -0.1};
  camera.hot = {0.002, 120.0, 3};
  const Misses misses = missesOf(camera, 3);
  EXPECT_GT(misses.corners, 280U);
  EXPECT_LT(misses.rms_px, 0.009);
  EXPECT_LT(misses.mean_px, 0.002);
}

TEST(CornerFit, FindsNoCornerWhereThereIsNone) {
  GrayImage image(64, 64, 120);
  const CornerGuess guess{{32.0, 32.0}, {20.0, 0.0}, {0.0, 20.0}, 8};
  EXPECT_FALSE(fitCorner(image, guess));
  for (int y = 0; y < 64; ++y) {
    for (int x = 32; x < 64; ++x) image.at(x, y) = 200;
  }
  EXPECT_FALSE(fitCorner(image, guess)) << "an edge";
  EXPECT_FALSE(fitCorner(image, {{3.0, 32.0}, {20.0, 0.0}, {0.0, 20.0}, 8})) << "outside";
}

}  // namespace
}  // namespace kerfbench::calibrate
