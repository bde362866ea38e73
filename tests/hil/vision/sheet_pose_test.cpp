// SPDX-License-Identifier: Apache-2.0
// The sheet's pose in a frame and its covariance, compared with the model's web.
#include <cmath>
#include <cstdio>
#include <functional>

#include <gtest/gtest.h>
#include <Eigen/LU>

#include "tests/hil/vision/spot_twin.h"
#include "twin/base/image.h"
#include "twin/base/random.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kFrames = 1200;

struct Case {
  const char* name;
  PrintLayout print;
  std::function<void(twin::CameraDescription&)> apply;
  bool lone{};          ///< True if the web moves on until one mark is in view.
  double limit = 1.15;  ///< Upper limit of mean squares; the lower one is 0.85.
};

PrintLayout marksAt(std::vector<Vector2d> places_mm) {
  PrintLayout print;
  print.units = 1;
  print.pitch_mm = 100.0;
  for (const Vector2d& p : places_mm) print.marks.push_back({p, 3.0});
  return print;
}

struct Truth {
  Vector2d p_WS_mm;
  double angle_rad;
};

/// Mean squares of the errors of x, y, angle over what the covariance states, and of all together.
struct Normalised {
  Vector3d z2{Vector3d::Zero()};
  double mahalanobis{};
  Vector3d squares{Vector3d::Zero()}, stated{Vector3d::Zero()};
  int count{};
};

void add(Normalised& sums, const SheetPose& pose, const Truth& truth) {
  const Vector2d d = pose.p_WS_mm - truth.p_WS_mm;
  const Vector3d error(d.x(), d.y(), pose.angle_rad - truth.angle_rad);
  sums.z2 += error.cwiseAbs2().cwiseQuotient(pose.covariance.diagonal()) / kFrames;
  sums.mahalanobis += error.dot(pose.covariance.inverse() * error) / kFrames;
  sums.squares += error.cwiseAbs2() / kFrames;
  sums.stated += pose.covariance.diagonal() / kFrames;
  ++sums.count;
}

Normalised normalised(const Case& one) {
  Normalised sums;
  const CounterRandom random(11, 1);
  for (int i = 0; i < kFrames; ++i) {
    const auto k = static_cast<std::uint64_t>(i);
    // The frames have another camera noise and another board each time, and marks anywhere on the pixels'
    // raster.
    twin::CameraDescription description = test::spotCamera();
    one.apply(description);
    description.board_seed = k + 1;
    const twin::SpotCamera camera(description, one.print, test::kGlowGrayPerW, k + 1);
    const Truth truth{{random.uniform(3 * k) - 0.5, random.uniform(3 * k + 1) - 0.5},
                      0.02 * (random.uniform(3 * k + 2) - 0.5)};
    constexpr double kStepMm = 3.0;
    std::vector<Frame> frames;
    for (std::uint64_t s = 0; s < (one.lone ? 7U : 1U); ++s) {
      const double ahead_mm = one.lone ? kStepMm * (static_cast<double>(s) - 6.0) : 0.0;
      const Vector2d p_WS_mm = truth.p_WS_mm + Vector2d(ahead_mm, 0.0);
      frames.push_back(camera.render({.sequence = s,
                                      .start_s = 1e-3 * static_cast<double>(s),
                                      .samples = {{.p_WS_mm = p_WS_mm, .angle_rad = truth.angle_rad}}}));
    }
    const SpotTrack track =
        test::trackOf(description, one.print, std::move(frames), one.lone ? kStepMm / 1e-3 : 0.0);
    const FrameMeasurement& last = track.frames.back();
    EXPECT_EQ(last.sheet.size(), 1U) << one.name << i;
    if (last.sheet.size() != 1) continue;
    EXPECT_EQ(last.sheet[0].marks == 1, one.lone);
    add(sums, last.sheet[0], truth);
  }
  return sums;
}

// The mean of 1200 squares of a standard normal variable is 1 +- sqrt(2 / 1200) = 0.041 at one sigma: the
// band of 0.15 is 3.7 of them, missed by an honest covariance once in some 4000 components. Coarse grain has
// more variance round the disc than between neighbouring sectors, from which a mark's noise is estimated:
// there the stated standard uncertainty is up to 15 % too small.
TEST(SheetPose, CovarianceIsHonest) {
  const PrintLayout four = marksAt({{-9.0, -8.0}, {9.0, -7.5}, {-9.5, 8.0}, {9.0, 8.5}});
  const auto clean = [](twin::CameraDescription&) {};
  const std::vector<Case> cases{
      {"four marks", four, clean},
      {"three marks", marksAt({{-9.0, -8.0}, {9.0, -7.5}, {9.0, 8.5}}), clean},
      {"two marks", marksAt({{-9.0, -6.0}, {9.0, 7.0}}), clean},
      {"one mark", marksAt({{4.0, -6.0}, {15.0, 7.0}}), clean, true},
      {"noisy", four, [](twin::CameraDescription& c) { c.read_noise = 3.0; }},
      {"12 bits", four, [](twin::CameraDescription& c) { c.bits = 12; }},
      {"grain", four, [](twin::CameraDescription& c) { c.texture = {.grain_gray = 3.0}; }, false, 1.4},
  };
  for (const Case& one : cases) {
    const Normalised n = normalised(one);
    ASSERT_EQ(n.count, kFrames);
    const Vector3d ratio = n.squares.cwiseQuotient(n.stated);
    std::printf("  %-12s z² %.3f %.3f %.3f, Mahalanobis %.2f of 3; squares over stated %.3f %.3f %.3f\n",
                one.name, n.z2.x(), n.z2.y(), n.z2.z(), n.mahalanobis, ratio.x(), ratio.y(), ratio.z());
    for (int i = 0; i < 3; ++i) {
      EXPECT_GT(n.z2[i], 0.85) << one.name << " " << i;
      EXPECT_LT(n.z2[i], one.limit) << one.name << " " << i;
    }
  }
}

}  // namespace
}  // namespace kerfbench::vision
