// SPDX-License-Identifier: Apache-2.0
// The light across a curve, on pictures without any curve.
#include "hil/vision/kerf/kerf_profile.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/hil/vision/synthetic.h"

namespace kerfbench::vision {
namespace {

constexpr double kPitch_mm = 0.03;
constexpr double kGray = 60.0;

TEST(KerfProfile, CountsAsManyPixelsAtOneEndAsAtTheOther) {
  const CameraCalibration camera = test::tiltedCamera(400, 300, kPitch_mm);
  const TileView view =
      viewTile({GrayImage(400, 300, static_cast<std::uint8_t>(kGray)), {0.0, 0.0}, 0}, camera, {});
  for (const double angle_rad : {0.0, 0.4, 1.2}) {
    CaliperWindow window;
    window.p_S_mm = camera.planeFromPixel({200.0, 150.0});
    window.tangent = {std::cos(angle_rad), std::sin(angle_rad)};
    Profile profile;
    readProfile(view, camera, PlaneMotion{}, window, {}, profile);
    ASSERT_GT(profile.size(), 20U);
    // A window is 0.2 mm long and 1.2 mm wide: as many pixels as fit in are in all samples together.
    double pixels = 0.0;
    for (std::size_t i = 0; i < profile.size(); ++i) pixels += profile.weight[i];
    const auto endOf = [&](bool last) {
      double sum = 0.0;
      for (std::size_t i = 0; i < 4; ++i) sum += profile.weight[last ? profile.size() - 1 - i : i];
      return sum / pixels;
    };
    EXPECT_NEAR(endOf(true), endOf(false), 0.15 * endOf(false)) << angle_rad;
    for (const std::size_t i : {std::size_t{0}, profile.size() / 2, profile.size() - 1})
      EXPECT_NEAR(profile.gray[i], kGray, 0.5) << angle_rad << ", sample " << i;
  }
}

TEST(KerfProfile, EndsWithThePicture) {
  // Half of a window lies beyond the first or the last row of the picture, where there is no light to read.
  constexpr int kHeight_px = 300;
  const CameraCalibration camera = test::tiltedCamera(400, kHeight_px, kPitch_mm);
  const TileView view =
      viewTile({GrayImage(400, kHeight_px, static_cast<std::uint8_t>(kGray)), {0.0, 0.0}, 0}, camera, {});
  const auto pixelsAt = [&](double row) {
    CaliperWindow window;
    window.p_S_mm = camera.planeFromPixel({200.0, row});
    window.tangent = Eigen::Vector2d::UnitY();
    Profile profile;
    readProfile(view, camera, PlaneMotion{}, window, {}, profile);
    return static_cast<double>(profile.pixels.size());
  };
  const double inside = pixelsAt(0.5 * kHeight_px);
  EXPECT_NEAR(pixelsAt(0.0), 0.55 * inside, 0.1 * inside);
  EXPECT_NEAR(pixelsAt(kHeight_px - 1.0), 0.55 * inside, 0.1 * inside);
}

}  // namespace
}  // namespace kerfbench::vision
