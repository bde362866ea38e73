// SPDX-License-Identifier: Apache-2.0
// Marks, and shapes that only look like marks.
#include "hil/vision/marks/mark_finder.h"

#include <gtest/gtest.h>

#include "tests/hil/vision/synthetic.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;

constexpr double kBoard = 120.0;
constexpr double kInk = 20.0;
constexpr double kDiameterMm = 3.0;
const Vector2d kPlace(1.3, -2.2);

class MarkFinder : public ::testing::Test {
 protected:
  CameraCalibration camera = test::tiltedCamera(320, 300, 0.1);
  test::Canvas canvas{camera, kBoard};

  void disc(const Vector2d& p_mm, double diameter_mm, double gray) { canvas.disc(p_mm, diameter_mm, gray); }
  [[nodiscard]] std::optional<FoundMark> seen() {
    canvas.blur(0.7);
    return measureMark(canvas.expose(4, 1), camera, kPlace + Vector2d(0.15, -0.1), kDiameterMm, 0.6);
  }
};

TEST_F(MarkFinder, MeasuresAWholeDiscOfTheRightSize) {
  disc(kPlace, kDiameterMm, kInk);
  const auto mark = seen();
  ASSERT_TRUE(mark);
  EXPECT_LT((mark->p_mm - kPlace).norm(), 4.0 * mark->sigma_mm);
  EXPECT_LT(mark->sigma_mm, 0.005);
}

TEST_F(MarkFinder, ASmallerDiscIsNoMark) {
  disc(kPlace, 0.84 * kDiameterMm, kInk);
  EXPECT_FALSE(seen());
}

TEST_F(MarkFinder, ALargerDiscIsNoMark) {
  disc(kPlace, 1.2 * kDiameterMm, kInk);
  EXPECT_FALSE(seen());
}

TEST_F(MarkFinder, ADiscWithAHoleIsNoMark) {
  disc(kPlace, kDiameterMm, kInk);
  disc(kPlace + Vector2d(0.3, 0.2), 0.9, kBoard);
  EXPECT_FALSE(seen());
}

TEST_F(MarkFinder, ADiscWithDirtBesideIsNoMark) {
  disc(kPlace, kDiameterMm, kInk);
  disc(kPlace + Vector2d(0.0, 2.6), 1.6, kInk);
  EXPECT_FALSE(seen());
}

TEST_F(MarkFinder, ADiscThatLiesTooFarOffIsAnother) {
  disc(kPlace + Vector2d(2.0, 0.0), kDiameterMm, kInk);
  EXPECT_FALSE(seen());
}

}  // namespace
}  // namespace kerfbench::vision
