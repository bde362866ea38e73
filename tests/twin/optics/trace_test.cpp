// SPDX-License-Identifier: Apache-2.0
// ScanHead against a slow, independent trace of the same description.
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "slow_trace.h"
#include "twin/base/random.h"
#include "twin/optics/scan_head.h"

namespace kerfbench::twin {
namespace {

using test::slowTrace;

// Values of one random machine, one after the other.
class Draw {
 public:
  explicit Draw(std::uint64_t machine) : random_(77, machine) {}
  double within(double most) { return most * (2.0 * random_.uniform(index_++) - 1.0); }
  std::array<double, 2> pair(double most) {
    const double first = within(most);
    return {first, within(most)};
  }
  bool coin() { return within(1.0) > 0; }

 private:
  CounterRandom random_;
  std::uint64_t index_{0};
};

MirrorAlignment someMirror(Draw& draw) {
  return {draw.pair(0.01), draw.within(3.0), draw.within(0.02), 1.0 + draw.within(0.02)};
}

ScanHeadDescription someHead(Draw& draw, bool with_lens) {
  ScanHeadDescription head;
  head.throw_mm = 450.0 + draw.within(150.0);
  head.mirror_spacing_mm = 30.0 + draw.within(20.0);
  head.y_mirror_first = draw.coin();
  head.x = someMirror(draw);
  head.y = someMirror(draw);
  if (with_lens) {
    head.lens = LensDescription{
        400.0 + draw.within(100.0), draw.within(0.05), draw.within(0.05), draw.pair(2.0), draw.pair(0.01),
        0.5 + draw.within(0.7)};
  }
  return head;
}

BeamDescription someBeam(Draw& draw) {
  return {0.15 + draw.within(0.05), 20.0 + draw.within(10.0), draw.within(5.0), draw.pair(2.0),
          draw.pair(0.005)};
}

SurfaceDescription someSurface(Draw& draw) {
  return {draw.within(3.0),       draw.pair(0.03),          draw.pair(1e-4),
          0.2 + draw.within(0.2), 20.0 + draw.within(20.0), 300.0 + draw.within(200.0),
          draw.within(3.0)};
}

// Height by the surface's formula, written down once more.
double heightOf(const SurfaceDescription& s, const Eigen::Vector2d& p, double time_s) {
  const Eigen::Vector2d slope(s.slope[0], s.slope[1]);
  const double bend = s.curvature_1_mm[0] * p.x() * p.x() + s.curvature_1_mm[1] * p.y() * p.y();
  const double turns = s.flutter_hz * time_s - p.x() / s.flutter_wavelength_mm;
  return s.height_mm + slope.dot(p) + 0.5 * bend +
         s.flutter_mm * std::sin(2.0 * M_PI * turns + s.flutter_phase_rad);
}

Eigen::Matrix2d matrixOf(const BeamSpot& spot) {
  const double mixed = spot.correlation * spot.radius_x_mm * spot.radius_y_mm;
  Eigen::Matrix2d S;
  S << spot.radius_x_mm * spot.radius_x_mm, mixed, mixed, spot.radius_y_mm * spot.radius_y_mm;
  return S;
}

class RandomHeads : public testing::TestWithParam<bool> {};

TEST_P(RandomHeads, HitTheSurfaceWhereTheSlowTraceDoesAsLargeAndAsFar) {
  double worst_mm = 0.0;
  for (std::uint64_t machine = 0; machine < 300; ++machine) {
    Draw draw(machine);
    const ScanHeadDescription head = someHead(draw, GetParam());
    const BeamDescription beam = someBeam(draw);
    const SurfaceDescription surface = someSurface(draw);
    const ScanHead fast(head, beam);
    const Surface board(surface);
    for (int i = 0; i < 10; ++i) {
      const Eigen::Vector2d mirror_rad(draw.within(0.15), draw.within(0.15));
      const double time_s = 1.0 + draw.within(1.0);
      const auto spot = fast.spotAt(mirror_rad, Eigen::Vector2d::Zero(), board, time_s);
      ASSERT_TRUE(spot) << machine;
      const auto slow = slowTrace(head, beam, mirror_rad,
                                  [&](const Eigen::Vector2d& p) { return heightOf(surface, p, time_s); });
      const Eigen::Vector3d p(spot->p_WQ_mm.x(), spot->p_WQ_mm.y(), spot->height_mm);
      worst_mm = std::max(worst_mm, (p - slow.p_W_mm).norm());
      ASSERT_LT((p - slow.p_W_mm).norm(), 1e-9) << machine;
      // The area of the footprint seen along Wz is pi w² over the cosine to the board, and that board's tilt.
      const double s = slow.defocus_mm / beam.rayleigh_mm;
      const double w2 = beam.waist_radius_mm * beam.waist_radius_mm * (1.0 + s * s);
      constexpr double kStep_mm = 1e-3;
      const Eigen::Vector2d q = slow.p_W_mm.head<2>();
      const Eigen::Vector2d dx(kStep_mm, 0.0);
      const Eigen::Vector2d dy(0.0, kStep_mm);
      const Eigen::Vector3d normal(
          (heightOf(surface, q - dx, time_s) - heightOf(surface, q + dx, time_s)) / (2.0 * kStep_mm),
          (heightOf(surface, q - dy, time_s) - heightOf(surface, q + dy, time_s)) / (2.0 * kStep_mm), 1.0);
      const double area = w2 / std::abs(slow.direction.dot(normal));
      ASSERT_NEAR(std::sqrt(matrixOf(*spot).determinant()) / area, 1.0, 1e-8) << machine;
    }
  }
  std::ostringstream worst;
  worst << worst_mm;
  RecordProperty("worst_mm", worst.str());
}

INSTANTIATE_TEST_SUITE_P(Trace, RandomHeads, testing::Values(false, true),
                         [](const auto& instance) { return instance.param ? "WithLens" : "WithoutLens"; });

// The footprint of parallel rays on a plane board is an affine picture of the beam's cross-section: the rim's
// mean of q qᵀ is S / 2 exactly.
TEST(Footprint, IsThePictureOfTheBeamsRimOnAPlaneBoard) {
  constexpr int kRays = 12;
  for (std::uint64_t machine = 0; machine < 100; ++machine) {
    Draw draw(1000 + machine);
    const ScanHeadDescription head = someHead(draw, false);
    BeamDescription beam = someBeam(draw);
    beam.rayleigh_mm = std::numeric_limits<double>::infinity();
    const SurfaceDescription surface{.height_mm = draw.within(2.0), .slope = draw.pair(0.1)};
    const Eigen::Vector2d mirror_rad(draw.within(0.15), draw.within(0.15));
    const auto spot = ScanHead(head, beam).spotAt(mirror_rad, Eigen::Vector2d::Zero(), Surface(surface), 0.0);
    ASSERT_TRUE(spot);
    Eigen::Matrix2d S = Eigen::Matrix2d::Zero();
    for (int i = 0; i < kRays; ++i) {
      const double angle = 2.0 * M_PI * i / kRays;
      const Eigen::Vector2d beside = beam.waist_radius_mm * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const auto ray = slowTrace(
          head, beam, mirror_rad, [&](const Eigen::Vector2d& p) { return heightOf(surface, p, 0.0); },
          beside);
      const Eigen::Vector2d q = ray.p_W_mm.head<2>() - spot->p_WQ_mm;
      S += 2.0 / kRays * q * q.transpose();
    }
    EXPECT_LT((matrixOf(*spot) - S).norm(), 1e-11) << machine;
  }
}

// The rays are a Gaussian bundle on a curled board at the corner of the field, where the ellipse is oblique.
TEST(Footprint, IsTheSpreadOfAGaussianBundleOfRays) {
  constexpr int kRays = 20000;
  const CounterRandom random(3, 4);
  const ScanHeadDescription head;
  const BeamDescription beam{.waist_radius_mm = 0.2, .rayleigh_mm = std::numeric_limits<double>::infinity()};
  const SurfaceDescription surface{.slope = {0.05, -0.03}, .curvature_1_mm = {1e-4, 2e-4}};
  const Eigen::Vector2d mirror_rad(0.15, 0.15);
  const auto spot = ScanHead(head, beam).spotAt(mirror_rad, Eigen::Vector2d::Zero(), Surface(surface), 0.0);
  ASSERT_TRUE(spot);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (std::uint64_t i = 0; i < kRays; ++i) {
    const Eigen::Vector2d beside =
        0.5 * beam.waist_radius_mm * Eigen::Vector2d(random.normal(2 * i), random.normal(2 * i + 1));
    const auto ray = slowTrace(
        head, beam, mirror_rad, [&](const Eigen::Vector2d& p) { return heightOf(surface, p, 0.0); }, beside);
    const Eigen::Vector2d q = ray.p_W_mm.head<2>() - spot->p_WQ_mm;
    spread += q * q.transpose() / kRays;
  }
  // Standard error of a variance: sqrt(2 / n) of it, 1 %; four of them.
  const Eigen::Matrix2d S = matrixOf(*spot);
  EXPECT_NEAR(4.0 * spread(0, 0) / S(0, 0), 1.0, 0.04);
  EXPECT_NEAR(4.0 * spread(1, 1) / S(1, 1), 1.0, 0.04);
  EXPECT_NEAR(spread(0, 1) / std::sqrt(spread(0, 0) * spread(1, 1)), spot->correlation,
              4.0 / std::sqrt(kRays));
  EXPECT_GT(spot->correlation, 0.05);
}

// The scan is post-objective: the waist is equally far from the tube for any mirror angles, so that it rises
// off the board towards the edges of the field.
TEST(Caustic, TheRadiusIsThatOfTheRealLengthOfPath) {
  const BeamDescription beam{.waist_radius_mm = 0.1, .rayleigh_mm = 15.0, .focus_z_mm = 2.0};
  const ScanHeadDescription head;
  const ScanHead fast(head, beam);
  const auto smallest = [&](const Eigen::Vector2d& mirror_rad, double height_mm) {
    const auto spot =
        fast.spotAt(mirror_rad, Eigen::Vector2d::Zero(), Surface({.height_mm = height_mm}), 0.0);
    // The ellipse's minor axis on a level board is the beam's own radius.
    return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(matrixOf(*spot)).eigenvalues()[0]);
  };
  for (const double height_mm : {-30.0, 0.0, 2.0, 5.0, 40.0}) {
    EXPECT_NEAR(smallest({0.0, 0.0}, height_mm), 0.1 * std::hypot(1.0, (height_mm - 2.0) / 15.0), 1e-12);
  }
  for (const double x_rad : {-0.15, 0.0, 0.07}) {
    for (const double y_rad : {-0.1, 0.0, 0.15}) {
      const auto slow = slowTrace(head, beam, {x_rad, y_rad}, [](const Eigen::Vector2d&) { return 0.0; });
      EXPECT_NEAR(smallest({x_rad, y_rad}, 0.0), 0.1 * std::hypot(1.0, (slow.path_mm - 513.0) / 15.0), 1e-10);
    }
  }
  // The defocus in the field's corner, by hand: the path is (d + L / cos 2b) / cos 2a there.
  const double path_mm = (15.0 + 500.0 / std::cos(0.3)) / std::cos(0.3);
  EXPECT_NEAR(smallest({0.15, 0.15}, 0.0), 0.1 * std::hypot(1.0, (path_mm - 513.0) / 15.0), 1e-10);
  EXPECT_GT(smallest({0.15, 0.15}, 0.0), 0.3);
}

// The board is a bowl z = x²/200 and the ray goes down along -x: at x = 30 it meets the board's face well, at
// x = 86 too flat.
TEST(Caustic, ABoardThatTheBeamOnlyGrazesHasNoSpot) {
  const Surface bowl({.curvature_1_mm = {0.01, 0.0}});
  const BeamCaustic caustic(0.1, 20.0);
  const auto spotFrom = [&](double foot_mm, double flattest) {
    const Eigen::Vector3d direction = Eigen::Vector3d(-1.0, 0.0, -1.0).normalized();
    const ChiefRay ray{Eigen::Vector3d(foot_mm, 0.0, 0.0) - 200.0 * direction, direction, 200.0, 0.0};
    return caustic.spotOn(bowl, 0.0, ray, flattest);
  };
  const auto spot = spotFrom(30.0 - 4.5, ScanHead::kFlattest);
  ASSERT_TRUE(spot);
  EXPECT_NEAR(spot->p_WQ_mm.x(), 30.0, 1e-10);
  EXPECT_TRUE(spotFrom(49.0, 0.07));
  EXPECT_FALSE(spotFrom(49.0, ScanHead::kFlattest));
  const ChiefRay from_below{{30.0, 0.0, -10.0}, Eigen::Vector3d::UnitZ(), 10.0, 0.0};
  EXPECT_FALSE(caustic.spotOn(bowl, 0.0, from_below, ScanHead::kFlattest));
}

}  // namespace
}  // namespace kerfbench::twin
