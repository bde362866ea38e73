// SPDX-License-Identifier: Apache-2.0
// Motion of the spot when an assumption of the paper's formula is broken. The reference figures were measured
// with another ray trace, before this one was written, over mirror angles of ±0.15 rad (a field of 300 mm)
// for L = 500 mm and d = 15 mm; they are the largest of random places and therefore up to 3 % below the
// corners'.
//
// Centring: the spot's displacement at rest is subtracted, as when the field is moved to where the beam at
// rest falls. The mirrors are not turned for it.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "twin/optics/scan_head.h"

namespace kerfbench::twin {
namespace {

constexpr double kField_rad = 0.15;
constexpr double kReferenceMiss = 0.03;

Eigen::Vector2d formula(const Eigen::Vector2d& mirror_rad) {
  const double y = 500.0 * std::tan(2.0 * mirror_rad.y());
  return {(std::hypot(500.0, y) + 15.0) * std::tan(2.0 * mirror_rad.x()), y};
}

// Largest distance from the formula's place over the field, after centring.
double worst_mm(const ScanHeadDescription& description, const BeamDescription& beam = {},
                const SurfaceDescription& board = {}) {
  const ScanHead head(description, beam);
  const Surface surface(board);
  const auto spot = [&](const Eigen::Vector2d& mirror_rad) {
    return head.spotAt(mirror_rad, Eigen::Vector2d::Zero(), surface, 0.0).value().p_WQ_mm;
  };
  const Eigen::Vector2d at_rest = spot(Eigen::Vector2d::Zero());
  double worst = 0.0;
  for (int i = -10; i <= 10; ++i) {
    for (int j = -10; j <= 10; ++j) {
      const Eigen::Vector2d mirror_rad = 0.1 * kField_rad * Eigen::Vector2d(i, j);
      worst = std::max(worst, (spot(mirror_rad) - at_rest - formula(mirror_rad)).norm());
    }
  }
  return worst;
}

void expectAbout(double value_mm, double reference_mm) {
  EXPECT_NEAR(value_mm, reference_mm, kReferenceMiss * reference_mm);
}

TEST(Alignment, AsDrawnThereIsNoDeviation) { EXPECT_LT(worst_mm({}), 1e-9); }

TEST(Alignment, SurfacesTwoMillimetresOffTheirAxes) {
  const MirrorAlignment off{.surface_offset_mm = 2.0};
  expectAbout(worst_mm({.x = off, .y = off}), 1.65);
  expectAbout(worst_mm({.x = off}), 0.53);
  expectAbout(worst_mm({.y = off}), 1.16);
}

TEST(Alignment, TheLaserBeamOneMillimetreOffTheXAxis) {
  expectAbout(worst_mm({}, {.offset_mm = {1.0, 0.0}}), 0.046);
  expectAbout(worst_mm({}, {.offset_mm = {-1.0, 0.0}}), 0.046);
}

// The reference does not state the point about which the beam was turned. Turned about the mirror it is 0.093
// and 0.075; about a point 100 mm before, where it then also passes the axis 0.1 mm off, 0.102 and 0.080.
TEST(Alignment, TheLaserBeamTiltedByOneMilliradian) {
  expectAbout(worst_mm({}, {.offset_mm = {0.0, -0.1}, .tilt_rad = {1e-3, 0.0}}), 0.10);
  expectAbout(worst_mm({}, {.tilt_rad = {1e-3, 0.0}}), 0.093);
  expectAbout(worst_mm({}, {.tilt_rad = {0.0, 1e-3}}), 0.075);
}

TEST(Alignment, AnyMirrorAxisTiltedByOneMilliradian) {
  for (const std::array<double, 2>& tilt : {std::array{1e-3, 0.0}, std::array{0.0, 1e-3}}) {
    for (const bool of_x : {true, false}) {
      ScanHeadDescription head;
      (of_x ? head.x : head.y).axis_tilt_rad = tilt;
      const double worst = worst_mm(head);
      EXPECT_GT(worst, 0.09 * (1.0 - kReferenceMiss)) << of_x << tilt[0];
      EXPECT_LT(worst, 0.11) << of_x << tilt[0];
    }
  }
}

TEST(Alignment, ThePlaneHalfAMillimetreLower) {
  expectAbout(worst_mm({}, {}, {.height_mm = -0.5}), 0.22);
  expectAbout(worst_mm({}, {}, {.height_mm = 0.5}), 0.22);
}

TEST(Alignment, TheMirrorsInTheWrongOrder) { expectAbout(worst_mm({.y_mirror_first = true}), 16.4); }

// A plane lower by h moves the spot by h times the tangent of incidence, along its own direction: exact.
TEST(Alignment, ALowerPlaneMovesTheSpotAlongTheRay) {
  const ScanHead head({}, {});
  const Surface high(SurfaceDescription{});
  const Surface low({.height_mm = -0.5});
  const auto above = head.spotAt({0.15, 0.1}, Eigen::Vector2d::Zero(), high, 0.0);
  const auto below = head.spotAt({0.15, 0.1}, Eigen::Vector2d::Zero(), low, 0.0);
  ASSERT_TRUE(above && below);
  const Eigen::Vector2d expected(0.5 * std::tan(0.3) / std::cos(0.2), 0.5 * std::tan(0.2));
  EXPECT_NEAR((below->p_WQ_mm - above->p_WQ_mm - expected).norm(), 0.0, 1e-12);
}

// A head without lens that is driven linearly draws a pincushion in x only, and the tangent on both axes.
TEST(Alignment, AnglesDrivenLinearlyGiveTheKnownDistortion) {
  const ScanHead head({}, {});
  const auto at = [&](double x_mm, double y_mm) {
    return head
        .spotAt({0.5 * x_mm / 515.0, 0.5 * y_mm / 500.0}, Eigen::Vector2d::Zero(),
                Surface(SurfaceDescription{}), 0.0)
        .value()
        .p_WQ_mm;
  };
  EXPECT_NEAR(at(150.0, 0.0).x(), 154.39, 0.01);
  EXPECT_NEAR(at(0.0, 150.0).y(), 154.67, 0.01);
  EXPECT_NEAR(at(150.0, 150.0).x(), 161.40, 0.01);
  EXPECT_NEAR(at(150.0, 150.0).y(), 154.67, 0.01);
}

}  // namespace
}  // namespace kerfbench::twin
