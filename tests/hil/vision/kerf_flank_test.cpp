// SPDX-License-Identifier: Apache-2.0
// What scorch beside a kerf does to its centre, from readings made by hand.
#include "hil/vision/kerf/kerf_flank.h"

#include <vector>

#include <gtest/gtest.h>

#include "hil/vision/kerf/flank_belief.h"

namespace kerfbench::vision {
namespace {

constexpr std::size_t kStations = 41;
constexpr double kPitch_mm = 0.1;

/// What remains uncertain in the middle of a cut on which the left board is this much brighter than the
/// right, by turns by so much more and less.
double uncertainMm(double odd_gray, double scatter_gray) {
  const KerfScanOptions options{.beam_radius_mm = 0.105, .open_gray = 200.0};
  const LensBlur blur{.px = 0.7, .sigma_px = 0.02};
  EntityPlan plan;
  plan.length_mm = kPitch_mm * (kStations - 1);
  plan.stations.resize(kStations);
  EntityKerf kerf;
  std::vector<KerfReading> readings;
  for (std::size_t i = 0; i < kStations; ++i) {
    Caliper& c = kerf.calipers.emplace_back();
    c.station_mm = kPitch_mm * static_cast<double>(i);
    c.found = true;
    readings.push_back({.found = true,
                        .width_mm = 0.2,
                        .low_width_mm = 0.24,
                        .high_width_mm = 0.16,
                        .brightness = 1.0,
                        .top_gray = 200.0,
                        .base_gray = 40.0,
                        .odd_gray = odd_gray + (i % 2 == 0 ? scatter_gray : -scatter_gray)});
  }
  std::vector<double> model_mm;
  correctFlankBias(plan, readings, {options, 0.03, blur},
                   beliefOf({}, {.beam_radius_mm = 0.105, .blur = blur}), kerf, model_mm);
  return model_mm.at(kStations / 2);
}

TEST(KerfFlank, ItsPlaceIsLessCertainWhereTheLightBesideItScatters) {
  const double even_mm = uncertainMm(4.0, 0.0);
  EXPECT_GT(even_mm, 0.0);
  EXPECT_GT(uncertainMm(4.0, 8.0), 1.1 * even_mm);
  EXPECT_GT(uncertainMm(4.0, 16.0), uncertainMm(4.0, 8.0));
}

}  // namespace
}  // namespace kerfbench::vision
