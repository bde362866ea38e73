// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/light_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::camera {
namespace {

using testing::HasSubstr;

/// A light on the pins and a camera of 200 frames/s whose clock is off.
struct LitBench {
  double period_s{5e-3};
  double exposure_s{1e-3};
  double offset_s{-4711.0};  ///< Offset of the pins' time from the camera's.
  double drift{60e-6};
  double jitter_s{50e-6};
  double late_s{};      ///< Delay of the light behind the pins.
  double unseen{0.05};  ///< Light that is not seen, as a share of an exposure that is lit throughout.
  double noise{0.02};   ///< Noise of the light.
  /// Spread of a sluggish light: it follows the pins from this long before to this long after.
  double spread_s{};
  double pulse_s{100e-6};  ///< Period of the PWM.
  std::uint64_t seed{1};
  std::vector<LightInterval> lights{};
  std::vector<LightProfile::Step> steps{};

  /// Adds uneven intervals.
  void addIntervals(int count) {
    const CounterRandom random(seed, 1);
    double at_s = 10.0;
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
      at_s += 0.02 + 0.1 * random.uniform(2 * i);
      const double on_s = at_s;
      at_s += 0.03 + 0.4 * random.uniform(2 * i + 1);
      lights.push_back({on_s, at_s});
    }
  }
  /// Adds `count` uneven intervals that are far apart.
  void addFarApart(int count, double span_s) {
    const CounterRandom random(seed, 3);
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::uint64_t>(i);
      const double on_s = 10.0 + span_s / count * (i + 0.5 * random.uniform(2 * k));
      lights.push_back({on_s, on_s + 0.1 + 0.2 * random.uniform(2 * k + 1)});
    }
  }
  /// Adds full light from begin to end of each interval, or by PWM over ramps of `ramp_s`.
  void light(double ramp_s) {
    for (const LightInterval& one : lights) {
      if (ramp_s == 0.0) {
        steps.push_back({one.on_s, true});
        steps.push_back({one.off_s, false});
      }
      for (double t = one.on_s; ramp_s > 0.0 && t < one.off_s; t += pulse_s) {
        const double share = std::min({(t - one.on_s) / ramp_s, (one.off_s - t) / ramp_s, 1.0});
        steps.push_back({t, true});
        steps.push_back({t + share * pulse_s, false});
      }
    }
  }
  [[nodiscard]] double stampOf(double pins_s) const { return (pins_s - offset_s) / (1.0 + drift); }
  [[nodiscard]] std::vector<FrameLight> frames() const {
    const CounterRandom random(seed, 2);
    const LightProfile profile(steps);
    std::vector<FrameLight> all;
    std::uint64_t i = 0;
    for (double t = lights.front().on_s - 0.3; t < lights.back().off_s + 0.3; t += period_s) {
      const double seen = profile.meanOver(t - late_s - spread_s, t - late_s + exposure_s + spread_s);
      const double light = 1000.0 * seen * (1.0 + noise * random.normal(2 * i));
      const double jitter = jitter_s * (2.0 * random.uniform(2 * i + 1) - 1.0);
      all.push_back({stampOf(t) + jitter, seen > unseen ? light : 0.0});
      ++i;
    }
    return all;
  }
  [[nodiscard]] CameraClockOptions options(double ask_s = 1e-3) const {
    return {.exposure_s = exposure_s,
            .stamp_jitter_s = jitter_s,
            .edge_error_s = 50e-6,
            .max_drift = 200e-6,
            .max_uncertainty_s = ask_s};
  }
  [[nodiscard]] CameraClockFit fit(const std::vector<FrameLight>& seen, double ask_s = 1e-3,
                                   bool profiled = true) const {
    const LightProfile profile(steps);
    return fitLightClock(seen, lights, profiled ? &profile : nullptr, period_s, options(ask_s));
  }
  /// Largest error of the clock over the lights, in units of its own bound.
  [[nodiscard]] double worstShare(const CameraClock& clock) const {
    double worst = 0.0;
    for (const LightInterval& one : lights) {
      for (const double t : {one.on_s, one.off_s}) {
        const double stamp_s = stampOf(t);
        worst = std::max(worst, std::abs(clock.beginOf_s(stamp_s) - t) / clock.uncertaintyAt_s(stamp_s));
      }
    }
    return worst;
  }
};

TEST(LightClock, HardEdgesBoundItByTheGateAlone) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    LitBench bench{.seed = seed};
    bench.addIntervals(30);
    bench.light(0.0);
    const CameraClockFit fit = bench.fit(bench.frames(), 2e-3, false);
    ASSERT_TRUE(fit.clock) << seed << ": " << fit.why_not;
    EXPECT_LE(bench.worstShare(*fit.clock), 1.0) << seed;
  }
}

// The gate alone opens twice: frames that show light bound each end from one side, dark ones from the other.
TEST(LightClock, DarkFramesBesideHardLightBoundItTwiceAsWell) {
  double lit_s = 0.0;
  double both_s = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    LitBench bench{.exposure_s = 4e-3, .seed = seed};
    bench.addIntervals(2);
    bench.light(0.0);
    CameraClockOptions options = bench.options(1.0);
    const CameraClockFit lit = fitLightClock(bench.frames(), bench.lights, nullptr, bench.period_s, options);
    options.is_light_hard = true;
    const CameraClockFit both = fitLightClock(bench.frames(), bench.lights, nullptr, bench.period_s, options);
    ASSERT_TRUE(lit.clock && both.clock) << seed << ": " << lit.why_not << both.why_not;
    EXPECT_LE(bench.worstShare(*both.clock), 1.0) << seed;
    const double middle_s = bench.stampOf(bench.lights.front().off_s);
    lit_s += lit.clock->uncertaintyAt_s(middle_s);
    both_s += both.clock->uncertaintyAt_s(middle_s);
  }
  EXPECT_LT(both_s, 0.35 * lit_s);
}

TEST(LightClock, ASpotThatIsMissedForAFrameIsNoEdgeOfHardLight) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    LitBench bench{.seed = seed};
    bench.addIntervals(4);
    bench.light(0.0);
    std::vector<FrameLight> seen = bench.frames();
    const auto first = std::ranges::find_if(seen, &FrameLight::isLit);
    (first + 1)->light = 0.0;
    (std::ranges::find_if(seen.rbegin(), seen.rend(), &FrameLight::isLit) + 1)->light = 0.0;
    CameraClockOptions options = bench.options(1.0);
    options.is_light_hard = true;
    const CameraClockFit fit = fitLightClock(seen, bench.lights, nullptr, bench.period_s, options);
    ASSERT_TRUE(fit.clock) << seed << ": " << fit.why_not;
    EXPECT_LE(bench.worstShare(*fit.clock), 1.0) << seed;
  }
}

TEST(LightClock, SoftEdgesBoundItWidelyAndTheirProfileSharpensIt) {
  int well_known = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    LitBench bench{.offset_s = 3.0 + 0.1 * static_cast<double>(seed), .unseen = 0.4, .seed = seed};
    bench.addIntervals(12);
    bench.light(15e-3);
    const std::vector<FrameLight> seen = bench.frames();
    const CameraClockFit wide = bench.fit(seen, 20e-3, false);
    const CameraClockFit sharp = bench.fit(seen, 20e-3);
    ASSERT_TRUE(wide.clock) << seed << ": " << wide.why_not;
    ASSERT_TRUE(sharp.clock) << seed << ": " << sharp.why_not;
    EXPECT_LE(bench.worstShare(*wide.clock), 1.0) << seed;
    EXPECT_LE(bench.worstShare(*sharp.clock), 1.0) << seed;
    const double middle_s = bench.stampOf(bench.lights[6].on_s);
    EXPECT_GT(wide.clock->uncertaintyAt_s(middle_s), 2e-3) << seed;
    EXPECT_LT(sharp.clock->uncertaintyAt_s(middle_s), wide.clock->uncertaintyAt_s(middle_s)) << seed;
    well_known += sharp.clock->uncertaintyAt_s(middle_s) < 0.8e-3 ? 1 : 0;
  }
  EXPECT_GE(well_known, 8);
}

// The exposure is a strobe of 5 us, and the laser follows its PWM sluggishly: the light of a millisecond is
// the information.
TEST(LightClock, OfAShortStrobeIsSharpenedByTheLightAroundIt) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    LitBench bench{.exposure_s = 5e-6, .unseen = 0.4, .spread_s = 0.5e-3, .seed = seed};
    bench.addIntervals(30);
    bench.light(15e-3);
    const std::vector<FrameLight> seen = bench.frames();
    const CameraClockFit wide = bench.fit(seen, 20e-3, false);
    const CameraClockFit sharp = bench.fit(seen, 20e-3);
    ASSERT_TRUE(wide.clock) << seed << ": " << wide.why_not;
    ASSERT_TRUE(sharp.clock) << seed << ": " << sharp.why_not;
    EXPECT_LE(bench.worstShare(*sharp.clock), 1.0) << seed;
    const double middle_s = bench.stampOf(bench.lights[15].on_s);
    EXPECT_GT(wide.clock->uncertaintyAt_s(middle_s), 2e-3) << seed;
    EXPECT_LT(sharp.clock->uncertaintyAt_s(middle_s), 1e-3) << seed;
  }
}

// The drift alone would leave a hundred million places.
TEST(LightClock, OfAShortStrobeInALongJobIsSharpenedToo) {
  for (const double drift : {-150e-6, 60e-6}) {
    LitBench bench{.exposure_s = 5e-6, .drift = drift, .unseen = 0.4, .spread_s = 0.5e-3};
    bench.addFarApart(20, 600.0);
    bench.light(15e-3);
    const CameraClockFit fit = bench.fit(bench.frames(), 20e-3);
    ASSERT_TRUE(fit.clock) << fit.why_not;
    EXPECT_LE(bench.worstShare(*fit.clock), 1.0) << drift;
    EXPECT_LT(fit.clock->uncertaintyAt_s(bench.stampOf(bench.lights[10].on_s)), 1e-3) << drift;
  }
}

// The exposure's own scale would leave some hundred thousand places.
TEST(LightClock, OfALongJobIsSharpenedByTheLightAroundFramesToo) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    LitBench bench{.exposure_s = 200e-6, .unseen = 0.4, .seed = seed};
    bench.addFarApart(40, 300.0);
    bench.light(15e-3);
    const CameraClockFit fit = bench.fit(bench.frames(), 20e-3);
    ASSERT_TRUE(fit.clock) << seed << ": " << fit.why_not;
    EXPECT_LE(bench.worstShare(*fit.clock), 1.0) << seed;
    EXPECT_LT(fit.clock->uncertaintyAt_s(bench.stampOf(bench.lights[20].on_s)), 1e-3) << seed;
  }
}

// Each lit frame shows one whole pulse of PWM and nothing of their number.
TEST(LightClock, OfAStrobeThatShowsSinglePulsesIsNotToldSharperThanItIs) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    LitBench bench{.exposure_s = 5e-6, .unseen = 0.4, .seed = seed};
    bench.addIntervals(30);
    bench.light(15e-3);
    const CameraClockFit fit = bench.fit(bench.frames(), 20e-3);
    ASSERT_TRUE(fit.clock) << seed << ": " << fit.why_not;
    EXPECT_LE(bench.worstShare(*fit.clock), 1.0) << seed;
  }
}

// Limitation stated in the documentation: the light's own delay cannot be separated from the clock's. A
// neighbouring minimum is as good there, for all frames alike.
TEST(LightClock, IsAsGoodAsItSaysWherePulsesAreAboutAsLongAsAnExposure) {
  for (const double pulse_s : {50e-6, 70e-6, 100e-6, 250e-6}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      LitBench bench{.exposure_s = 200e-6, .pulse_s = pulse_s, .seed = seed};
      bench.addIntervals(8);
      bench.light(10e-3);
      const CameraClockFit fit = bench.fit(bench.frames(), 10e-3);
      ASSERT_TRUE(fit.clock) << pulse_s << " s, " << seed << ": " << fit.why_not;
      EXPECT_LE(bench.worstShare(*fit.clock), 1.0) << pulse_s << " s, " << seed;
    }
  }
}

TEST(LightClock, TakesADelayThatAllLightsHaveForTheOffset) {
  LitBench bench{.late_s = 3e-3};
  bench.addIntervals(12);
  bench.light(15e-3);
  const CameraClockFit fit = bench.fit(bench.frames());
  ASSERT_TRUE(fit.clock) << fit.why_not;
  const double stamp_s = bench.stampOf(bench.lights[6].on_s);
  EXPECT_NEAR(fit.clock->beginOf_s(stamp_s) - bench.lights[6].on_s, -3e-3, 0.3e-3);
}

TEST(LightClock, LivesWithAFewReflexes) {
  LitBench bench;
  bench.addIntervals(20);
  bench.light(0.0);
  std::vector<FrameLight> seen = bench.frames();
  std::size_t reflexes = 0;
  for (std::size_t i = 1; i + 1 < seen.size() && reflexes < 3; i += 37) {
    if (seen[i - 1].isLit() || seen[i].isLit() || seen[i + 1].isLit()) continue;
    seen[i].light = 300.0;
    ++reflexes;
  }
  ASSERT_EQ(reflexes, 3U);
  const CameraClockFit fit = bench.fit(seen, 2e-3);
  ASSERT_TRUE(fit.clock) << fit.why_not;
  EXPECT_LE(bench.worstShare(*fit.clock), 1.0);
}

TEST(LightClock, OfLightsAllAlikeOfWhichOnlySomeWereSeenIsNone) {
  LitBench bench;
  for (int i = 0; i < 20; ++i) bench.lights.push_back({10.0 + 0.2037 * i, 10.1 + 0.2037 * i});
  bench.light(0.0);
  std::vector<FrameLight> seen = bench.frames();
  const double middle_s = bench.stampOf(12.02);
  std::erase_if(seen, [&](const FrameLight& frame) { return frame.stamp_s > middle_s; });
  const CameraClockFit fit = bench.fit(seen);
  EXPECT_FALSE(fit.clock);
  EXPECT_THAT(fit.why_not, HasSubstr("too much alike"));
  // All of them have but one place.
  EXPECT_TRUE(bench.fit(bench.frames(), 2e-3).clock);
}

TEST(LightClock, OfAnotherJobsLightIsNone) {
  LitBench bench{.seed = 3};
  bench.addIntervals(20);
  bench.light(0.0);
  LitBench other{.seed = 4};
  other.addIntervals(20);
  other.light(0.0);
  const CameraClockFit fit = bench.fit(other.frames());
  EXPECT_FALSE(fit.clock);
  EXPECT_THAT(fit.why_not, HasSubstr("fall outside of the times of light"));
}

TEST(LightClock, WithoutLightSaysSo) {
  LitBench bench;
  bench.addIntervals(3);
  bench.light(0.0);
  std::vector<FrameLight> seen = bench.frames();
  for (FrameLight& frame : seen) frame.light = 0.0;
  EXPECT_THAT(bench.fit(seen).why_not, HasSubstr("shows light"));
  EXPECT_THAT(fitLightClock(seen, {}, nullptr, bench.period_s, bench.options()).why_not,
              HasSubstr("pins show no light"));
}

TEST(LightClock, NotKnownAsWellAsAskedForSaysHowWell) {
  LitBench bench;
  bench.addIntervals(12);
  bench.light(15e-3);
  EXPECT_THAT(bench.fit(bench.frames(), 1e-6).why_not, HasSubstr("±0.001 ms are asked for"));
}

TEST(LightProfile, IsTheShareOfTimeOn) {
  const std::vector<LightProfile::Step> steps{{1.0, true}, {2.0, false}, {3.0, true}};
  const LightProfile profile(steps);
  EXPECT_DOUBLE_EQ(profile.meanOver(0.0, 1.0), 0.0);
  EXPECT_DOUBLE_EQ(profile.meanOver(0.5, 1.5), 0.5);
  EXPECT_DOUBLE_EQ(profile.meanOver(1.0, 3.0), 0.5);
  EXPECT_DOUBLE_EQ(profile.meanOver(5.0, 6.0), 1.0);
  EXPECT_DOUBLE_EQ(LightProfile({}).meanOver(0.0, 1.0), 0.0);
}

}  // namespace
}  // namespace kerfbench::camera
