// SPDX-License-Identifier: Apache-2.0
// What the scatter of readings along a cut tells of each of them, on readings whose noise is known.
#include "hil/vision/kerf/kerf_noise.h"

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace kerfbench::vision {
namespace {

constexpr double kPixels_mm = 1e-4;  ///< Noise of the pixels alone.

/// Cuts of equal length, each reading of which has the noise that its station says.
class Cuts {
 public:
  Cuts(std::size_t count, std::size_t stations, double pitch_mm,
       const std::function<double(double)>& sigma_mm)
      : kerfs_(count), noise_(count) {
    std::mt19937 random(5);
    std::normal_distribution<double> unit;
    for (std::size_t e = 0; e < count; ++e) {
      EntityPlan entity;
      entity.entity = static_cast<int>(e);
      entity.length_mm = pitch_mm * static_cast<double>(stations - 1);
      plan_.entities.push_back(entity);
      for (std::size_t i = 0; i < stations; ++i) {
        Caliper c;
        c.station_mm = pitch_mm * static_cast<double>(i);
        c.found = true;
        c.offset_mm = sigma_mm(c.station_mm) * unit(random);
        c.width_mm = 0.2 + 2.0 * sigma_mm(c.station_mm) * unit(random);
        kerfs_[e].calipers.push_back(c);
      }
      noise_[e].pixels_mm.assign(stations, kPixels_mm);
      noise_[e].board_mm.assign(stations, 0.0);
      noise_[e].grid_mm.assign(stations, 0.0);
      noise_[e].model_mm.assign(stations, 0.0);
    }
    setSigmas(plan_, noise_, kerfs_);
  }

  /// Mean over all cuts of what is stated at a station.
  [[nodiscard]] double sigmaAt(std::size_t station) const {
    double sum = 0.0;
    for (const EntityKerf& kerf : kerfs_) sum += kerf.calipers[station].sigma_mm;
    return sum / static_cast<double>(kerfs_.size());
  }

 private:
  KerfPlan plan_;
  std::vector<EntityKerf> kerfs_;
  std::vector<CutNoise> noise_;
};

TEST(KerfNoise, IsPooledOverMillimetresAndNotOverStations) {
  constexpr double kPitch_mm = 0.25;
  constexpr double kRough_mm = 100.0;  // From here on the cuts are rough.
  const Cuts cuts(20, 481, kPitch_mm, [](double at_mm) { return at_mm < kRough_mm ? 0.001 : 0.006; });
  const auto stationAt = [](double mm) { return static_cast<std::size_t>(mm / kPitch_mm); };
  const double far_mm = cuts.sigmaAt(stationAt(kRough_mm - 12.0));
  EXPECT_NEAR(far_mm, cuts.sigmaAt(stationAt(kRough_mm - 30.0)), 0.1 * far_mm);
  // Three millimetres before the rough part a quarter of the pool lies in it; of a pool of six stations none.
  EXPECT_GT(cuts.sigmaAt(stationAt(kRough_mm - 3.0)), 1.2 * far_mm);
}

TEST(KerfNoise, TheFirstDifferenceOfALineCounts) {
  // Four stations, 0.4 mm apart, make one third difference and no more.
  const Cuts cuts(400, 4, 0.4, [](double) { return 0.002; });
  EXPECT_NEAR(cuts.sigmaAt(0), 0.002, 0.0004) << "the pixels alone would leave " << kPixels_mm;
}

TEST(KerfNoise, AReadingFarOffIsAStepThoughOneLineIsAllThereIs) {
  const Cuts cuts(1, 241, 0.25, [](double at_mm) { return at_mm == 30.0 ? 2.0 : 0.002; });
  EXPECT_NEAR(cuts.sigmaAt(120), 0.002, 0.0015);
}

TEST(KerfNoise, OfLinesTooShortForADifferenceIsThatOfThePixels) {
  const Cuts cuts(3, 3, 0.4, [](double) { return 0.002; });
  EXPECT_GT(cuts.sigmaAt(1), 0.0);
  EXPECT_LT(cuts.sigmaAt(1), 0.001);
}

TEST(KerfNoise, IsTheSameFromEitherEndOfALine) {
  // Cuts that are rough over their last third, and others over their first.
  constexpr std::size_t kStations = 301;
  constexpr double kPitch_mm = 0.25;
  const double rough_mm = kPitch_mm * 200;
  const double length_mm = kPitch_mm * (kStations - 1);
  const Cuts late(60, kStations, kPitch_mm, [&](double at_mm) { return at_mm > rough_mm ? 0.006 : 0.001; });
  const Cuts early(60, kStations, kPitch_mm,
                   [&](double at_mm) { return at_mm < length_mm - rough_mm ? 0.006 : 0.001; });
  // As far from the rough part as the pool reaches each station nearer takes in one more difference of it.
  for (std::size_t station = 172; station < 186; ++station) {
    const double sigma_mm = late.sigmaAt(station);
    EXPECT_NEAR(early.sigmaAt(kStations - 1 - station), sigma_mm, 0.06 * sigma_mm) << station;
  }
}

TEST(KerfNoise, IsThatOfTheReadingsHoweverDenseTheyAre) {
  for (const double pitch_mm : {0.25, 0.1, 0.05}) {
    const Cuts cuts(20, 241, pitch_mm, [](double) { return 0.002; });
    EXPECT_NEAR(cuts.sigmaAt(120), 0.002, 0.0002) << pitch_mm;
  }
}

}  // namespace
}  // namespace kerfbench::vision
