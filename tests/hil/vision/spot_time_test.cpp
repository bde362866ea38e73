// SPDX-License-Identifier: Apache-2.0
// Time at which a place was seen.
#include <gtest/gtest.h>

#include "tests/hil/vision/spot_twin.h"
#include "twin/base/image.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

TEST(SpotTime, APlaceIsThatOfTheMiddleOfItsExposure) {
  twin::CameraDescription description = test::spotCamera();
  description.exposure_s = 500e-6;
  const twin::SpotCamera camera(description, test::noPrint(), test::kGlowGrayPerW, 1);
  // Travel in half an exposure is 0.1 mm.
  const Vector2d speed_mm_s(400.0, 0.0);
  const auto placeAt = [&](double time_s) { return Vector2d(Vector2d(-3.0, 2.0) + time_s * speed_mm_s); };
  std::vector<Frame> frames;
  for (std::uint64_t i = 0; i < 12; ++i) {
    const double start_s = test::exposureOf(i, {}, {}, 0.0).start_s;
    const Vector2d begin = placeAt(start_s);
    const Vector2d end = placeAt(start_s + description.exposure_s);
    frames.push_back(camera.render(test::exposureOf(i, 0.5 * (begin + end), end - begin, 200.0)));
  }
  for (const FrameMeasurement& frame :
       test::trackOf(description, test::noPrint(), std::move(frames)).frames) {
    ASSERT_TRUE(frame.spot_W_mm) << frame.sequence;
    EXPECT_LT((*frame.spot_W_mm - placeAt(frame.mid_s)).norm(), 0.02) << frame.sequence;
  }
}

}  // namespace
}  // namespace kerfbench::vision
