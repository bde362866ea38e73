// SPDX-License-Identifier: Apache-2.0
// Kerfs that wind: as a beam cuts them that follows the steps of its mirrors, or as a fault with waves.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "hil/dieline/geometry.h"
#include "hil/vision/kerf/kerf_flank.h"
#include "tests/hil/vision/kerf_twin.h"

namespace kerfbench::vision {
namespace {

using Eigen::Vector2d;
using test::TwinCut;

constexpr double kHalfMm = 12.0;
constexpr double kStepMm = 0.02;

/// One line of 24 mm, slightly askew, cut with a deviation that is given over the length.
struct Winding {
  TwinCut cut;
  int id{};

  explicit Winding(const std::function<double(double)>& deviation_mm) {
    id = cut.add(dieline::LineCurve{{-kHalfMm, -1.0}, {kHalfMm, -0.3}});
    cut.share_of[id] = 0.0;
    cut.also = [this, deviation_mm](twin::Sheet& sheet) {
      const dieline::Curve& curve = cut.dieline.entities[static_cast<std::size_t>(id)].curve;
      const double length_mm = dieline::lengthOf(curve);
      const Vector2d along = dieline::tangentAt(curve, 0.5);
      const Vector2d left(-along.y(), along.x());
      const auto at = [&](double s_mm) -> Vector2d {
        return dieline::pointAt(curve, s_mm / length_mm) + deviation_mm(s_mm) * left;
      };
      for (double s_mm = 0.0; s_mm < length_mm; s_mm += kStepMm)
        cut.burn(sheet, at(s_mm), at(std::min(s_mm + kStepMm, length_mm)), cut.fluence_share);
    };
  }
  Winding(const Winding&) = delete;
};

double meanSigma_mm(const EntityKerf& kerf) {
  double sum = 0.0, count = 0.0;
  for (const Caliper& c : kerf.calipers) {
    if (!c.found || c.near_joint) continue;
    sum += c.sigma_mm;
    count += 1.0;
  }
  return sum / count;
}

TEST(WindingKerf, IsNotTakenForNoise) {
  // The deviation has sawteeth of 6 um, 1.3 mm long: a mirror's step while the belt runs on.
  const Winding steps([](double s_mm) { return 0.006 * (std::fmod(s_mm, 1.3) / 1.3 - 0.5); });
  const Winding even([](double) { return 0.0; });
  const KerfScan wound = steps.cut.scan();
  const KerfScan straight = even.cut.scan();
  ASSERT_TRUE(wound.problems.empty()) << wound.problems.front();
  const double sigma_mm = meanSigma_mm(test::entityOf(wound, steps.id));
  // The scatter at 0.35 mm and more alone would give 1.5 um.
  EXPECT_LT(sigma_mm, 2.5 * meanSigma_mm(test::entityOf(straight, even.id)));
  EXPECT_LT(sigma_mm, 0.0009);
}

/// Amplitude of the wave that the readings show, by least squares.
double amplitude_mm(const EntityKerf& kerf, double wave_mm) {
  double sin_sum = 0.0, cos_sum = 0.0, count = 0.0;
  for (const Caliper& c : kerf.calipers) {
    // The range has whole waves, away from the ends.
    if (c.station_mm < wave_mm || c.station_mm >= 7.0 * wave_mm || !c.found) continue;
    const double phase = 2.0 * std::numbers::pi * c.station_mm / wave_mm;
    sin_sum += c.offset_mm * std::sin(phase);
    cos_sum += c.offset_mm * std::cos(phase);
    count += 1.0;
  }
  return 2.0 / count * std::hypot(sin_sum, cos_sum);
}

TEST(WindingKerf, IsReadAsHighAsItIs) {
  constexpr double kWaveMm = 2.6;
  constexpr double kAmplitudeMm = 0.06;
  const double per_mm = 2.0 * std::numbers::pi / kWaveMm;
  const Winding wave([&](double s_mm) { return kAmplitudeMm * std::sin(per_mm * s_mm); });
  const KerfScan scan = wave.cut.scan();
  ASSERT_TRUE(scan.problems.empty()) << scan.problems.front();
  // The beam's own radius takes (2 pi / wave)² w² / 8 of it; window and lens would take 1.2 % more.
  const double w_mm = test::kBeamRadiusMm;
  const double truth_mm = kAmplitudeMm * (1.0 - per_mm * per_mm * w_mm * w_mm / 8.0);
  EXPECT_NEAR(amplitude_mm(test::entityOf(scan, wave.id), kWaveMm), truth_mm, 0.005 * kAmplitudeMm);
}

TEST(KerfWidth, IsThatOfTheLightAndNotOfItsBlur) {
  for (const double share : {1.2, 1.5, 2.5, 4.0}) {
    TwinCut cut;
    cut.fluence_share = share;
    const int id = cut.add(dieline::LineCurve{{-kHalfMm, -1.0}, {kHalfMm, -0.3}});
    const KerfScan scan = cut.scan();
    double sum_mm = 0.0, count = 0.0;
    for (const Caliper& c : test::entityOf(scan, id).calipers) {
      if (!c.found || c.station_mm < 1.0 || c.station_mm > 2.0 * kHalfMm - 1.0) continue;
      sum_mm += c.width_mm;
      count += 1.0;
    }
    // Beer's law over the remaining depth: half of the light between board and open kerf.
    const double t = cut.board.transmission;
    const double half_share = 1.0 - std::log(0.5 * (1.0 + t)) / std::log(t);
    const double truth_mm = 2.0 * test::kBeamRadiusMm * std::sqrt(0.5 * std::log(share / half_share));
    EXPECT_NEAR(sum_mm / count, truth_mm, 0.003) << "share " << share;
  }
}

TEST(WindingKerf, ACircleIsStraightenedTheSameAllAroundItsSeam) {
  // Six waves around a closed curve of 30 mm: whatever is taken off is the same share of the wave at every
  // station.
  constexpr std::size_t kStations = 121;
  EntityPlan plan;
  plan.closed = true;
  plan.length_mm = 30.0;
  EntityKerf kerf;
  std::vector<double> wave_mm;
  for (std::size_t i = 0; i < kStations; ++i) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / (kStations - 1);
    wave_mm.push_back(0.02 * std::cos(6.0 * turn + 0.3));
    Caliper c;
    c.found = true;
    c.offset_mm = wave_mm.back();
    kerf.calipers.push_back(c);
  }
  correctCurvatureBias(plan, 0.02, kerf);
  const double share = kerf.calipers[kStations / 2].offset_mm / wave_mm[kStations / 2];
  EXPECT_GT(share, 1.0);
  for (std::size_t i = 0; i < kStations; ++i)
    EXPECT_NEAR(kerf.calipers[i].offset_mm, share * wave_mm[i], 1e-9) << i;
}

}  // namespace
}  // namespace kerfbench::vision
