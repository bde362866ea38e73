// SPDX-License-Identifier: Apache-2.0
// The unit's place on the table and its covariance, compared with the model's.
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "hil/dieline/geometry.h"
#include "hil/vision/marks/constellation.h"
#include "tests/hil/vision/kerf_twin.h"

namespace kerfbench::vision {
namespace {

using test::TwinCut;

struct PoseErrors {
  Eigen::Vector3d z2{Eigen::Vector3d::Zero()};  ///< Mean squares of x, y, angle over their stated sigmas.
  double mahalanobis{};                         ///< Mean of error' covariance^-1 error, 3 if honest.
  Eigen::Vector3d rms{Eigen::Vector3d::Zero()};
};

PoseErrors poseErrors(int seeds, const std::function<void(TwinCut&)>& apply) {
  PoseErrors out;
  for (int seed = 1; seed <= seeds; ++seed) {
    TwinCut cut;
    cut.seed = cut.camera.board_seed = static_cast<std::uint64_t>(seed);
    cut.add(dieline::LineCurve{{-5.0, 0.0}, {5.0, 0.0}});
    apply(cut);
    const KerfScan scan = cut.scan();
    EXPECT_EQ(scan.units.size(), 1U);
    if (scan.units.size() != 1) return out;
    const UnitPose& pose = scan.units.front();
    EXPECT_EQ(pose.marks, static_cast<int>(cut.print.marks.size()));
    const Eigen::Isometry2d truth = cut.lay();
    const Eigen::Vector3d error((pose.p_TS_mm - truth.translation()).x(),
                                (pose.p_TS_mm - truth.translation()).y(),
                                pose.angle_rad - Eigen::Rotation2Dd(truth.linear()).angle());
    out.z2 += error.cwiseAbs2().cwiseQuotient(pose.covariance.diagonal()) / seeds;
    out.mahalanobis += error.dot(pose.covariance.inverse() * error) / seeds;
    out.rms += error.cwiseAbs2() / seeds;
  }
  out.rms = out.rms.cwiseSqrt();
  return out;
}

void report(const char* name, const PoseErrors& e) {
  std::printf("  %-12s rms %.3f %.3f um %.2f urad, z %.2f %.2f %.2f, Mahalanobis %.2f of 3\n", name,
              1e3 * e.rms.x(), 1e3 * e.rms.y(), 1e6 * e.rms.z(), std::sqrt(e.z2.x()), std::sqrt(e.z2.y()),
              std::sqrt(e.z2.z()), e.mahalanobis);
}

// The RMS of an honest z is 1 +- 0.08 at one sigma for 80 seeds.
TEST(KerfPose, CovarianceIsHonest) {
  struct Case {
    const char* name;
    std::function<void(TwinCut&)> apply;
  };
  const std::vector<Case> cases{
      {"clean", [](TwinCut&) {}},
      {"noisy", [](TwinCut& c) { c.camera.read_noise = 2.5; }},
      {"grain", [](TwinCut& c) { c.camera.texture = {.grain_gray = 3.0, .grain_length_mm = 0.1}; }},
      {"uneven", [](TwinCut& c) { c.camera.light = {.vignette = 0.2, .gradient_x = 0.2}; }},
      {"three marks", [](TwinCut& c) { c.print.marks.pop_back(); }},
  };
  for (const Case& one : cases) {
    const PoseErrors e = poseErrors(80, one.apply);
    report(one.name, e);
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(std::sqrt(e.z2[i]), 0.75) << one.name << i;
      EXPECT_LT(std::sqrt(e.z2[i]), 1.25) << one.name << i;
    }
  }
}

TEST(KerfPose, CovarianceHasTheLeverArmOfTheOrigin) {
  // The marks are far from S's origin: its place is as uncertain as their angle makes it, and the two are
  // correlated.
  std::vector<MarkPair> pairs;
  for (const double x : {100.0, 140.0}) {
    for (const double y : {-10.0, 10.0}) pairs.push_back({{x, y}, {x, y}, 0.001});
  }
  const Eigen::Matrix3d c = motionCovariance(pairs, {});
  // Variances by hand: angle variance sigma² / sum of squared distances from the middle (4 * (400 + 100)),
  // times the belief's scale 6 / 11 of residuals that are all zero.
  const double scale = 6.0 / 11.0;
  EXPECT_NEAR(c(2, 2), scale * 1e-6 / 2000.0, 1e-14);
  EXPECT_NEAR(c(1, 1), scale * 1e-6 * (1.0 / 4.0 + 120.0 * 120.0 / 2000.0), 1e-9);
  EXPECT_NEAR(c(1, 2), -120.0 * c(2, 2), 1e-12);
  EXPECT_NEAR(c(0, 0), scale * 1e-6 / 4.0, 1e-9);
}

}  // namespace
}  // namespace kerfbench::vision
