// SPDX-License-Identifier: Apache-2.0
#include "hil/desk/drawing_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "hil/dieline/geometry.h"

namespace kerfbench::desk {
namespace {

using Eigen::Vector2d;

double distanceMm(const Vector2d& p, const std::vector<Vector2d>& line) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vector2d ab = line[i] - line[i - 1];
    const double u =
        ab.squaredNorm() > 0.0 ? std::clamp((p - line[i - 1]).dot(ab) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
    best = std::min(best, (p - line[i - 1] - u * ab).norm());
  }
  return best;
}

dieline::BezierCurve bezier(const Eigen::Matrix<double, 2, 4>& control) {
  return {control, Eigen::Vector4d(1.0, 2.5, 0.4, 1.0)};
}

TEST(DrawingJson, PolylinesLeaveTheirCurvesByAHundredthOfAMillimetreAtMost) {
  Eigen::Matrix<double, 2, 4> wave, loop;
  wave << 0, 40, -40, 0, 0, 10, 30, 40;
  loop << 0, 60, -60, 5, 0, 50, 50, 0;
  const std::vector<dieline::Curve> curves{dieline::LineCurve{{1, 2}, {3, 4}},
                                           dieline::ArcCurve{{5, 5}, 300.0, 0.3, -2.0 * std::numbers::pi},
                                           dieline::ArcCurve{{5, 5}, 0.004, 0.0, 6.0},
                                           dieline::EllipseCurve{{0, 0}, {90, 10}, {-1, 9}, 0.2, 5.9},
                                           bezier(wave),
                                           bezier(loop)};
  for (const dieline::Curve& curve : curves) {
    const std::vector<Vector2d> line = polylineOf(curve);
    EXPECT_EQ(line.front(), dieline::pointAt(curve, 0.0));
    EXPECT_NEAR((line.back() - dieline::pointAt(curve, 1.0)).norm(), 0.0, 1e-9);
    for (int i = 0; i <= 5000; ++i)
      ASSERT_LE(distanceMm(dieline::pointAt(curve, i / 5000.0), line), kDrawnWithin_mm * (1.0 + 1e-9));
    EXPECT_LT(line.size(), 1000U);
  }
}

TEST(DrawingJson, TheLineOfAnOriginIsItsNumber) {
  EXPECT_EQ(lineOfOrigin("line 204: LWPOLYLINE"), 204);
  EXPECT_EQ(lineOfOrigin("page 2"), 0);
  EXPECT_EQ(lineOfOrigin("line of thought"), 0);
}

}  // namespace
}  // namespace kerfbench::desk
