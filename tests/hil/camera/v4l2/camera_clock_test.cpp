// SPDX-License-Identifier: Apache-2.0
#include "hil/camera/v4l2/camera_clock.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::camera {
namespace {

using testing::Contains;
using testing::HasSubstr;

/// A camera of 120 frames/s whose clock is off, and edges of a light on the pins, seen in its frames.
struct Bench {
  double period_s{1.0 / 120.0};
  double exposure_s{2e-3};
  double offset_s{-0.0314};
  double drift{83e-6};
  double jitter_s{50e-6};
  double unseen_share{0.1};
  double share_error{};  ///< Error of the measured share of light; > 0: the share is measured.
  std::uint64_t seed{1};

  [[nodiscard]] double begin_s(double stamp_s) const { return stamp_s + offset_s + drift * stamp_s; }

  /// Sighting of a light that goes on at a phase (0 … 1) of the period that begins with frame `number`.
  [[nodiscard]] EdgeSighting sight(std::uint64_t number, double phase) const {
    const CounterRandom random(seed, 7);
    const auto stamp_s = [&](std::uint64_t n) { return period_s * static_cast<double>(n); };
    const auto told_s = [&](std::uint64_t n) {
      return stamp_s(n) + jitter_s * (2.0 * random.uniform(n) - 1.0);
    };
    const double into_s = phase * period_s;
    const double light_s = std::max(0.0, exposure_s - into_s);  // Light in frame `number`.
    const double threshold = unseen_share * random.uniform(number + 1'000'000);
    const std::uint64_t lit = light_s > threshold * exposure_s ? number : number + 1;
    EdgeSighting seen{begin_s(stamp_s(number)) + into_s, told_s(lit - 1), told_s(lit), 0.0, std::nullopt};
    if (share_error > 0.0) {
      const double share = lit == number ? light_s / exposure_s : 1.0;
      const double error = share_error * (2.0 * random.uniform(number + 2'000'000) - 1.0);
      seen.lit_share = std::clamp(share + error, 0.0, 1.0);
    }
    return seen;
  }

  /// Edges at any phase, spread over `frames`.
  [[nodiscard]] std::vector<EdgeSighting> sightings(int count, std::uint64_t frames = 12'000) const {
    const CounterRandom random(seed, 8);
    std::vector<EdgeSighting> all;
    for (int i = 0; i < count; ++i) {
      const auto n = static_cast<std::uint64_t>(i);
      all.push_back(sight(1 + n * frames / static_cast<std::uint64_t>(count), random.uniform(n)));
    }
    return all;
  }

  [[nodiscard]] CameraClockOptions options() const {
    return {.exposure_s = exposure_s,
            .stamp_jitter_s = jitter_s,
            .unseen_share = unseen_share,
            .share_error = share_error,
            .max_drift = 500e-6,
            .max_uncertainty_s = 0.02};
  }

  /// Largest error of the clock over the sightings, in units of its stated bound.
  [[nodiscard]] double worstShare(const CameraClock& clock, const std::vector<EdgeSighting>& seen) const {
    double worst = 0.0;
    for (const EdgeSighting& one : seen) {
      const double stamp_s = one.lit_stamp_s;
      worst = std::max(
          worst, std::abs(clock.beginOf_s(stamp_s) - begin_s(stamp_s)) / clock.uncertaintyAt_s(stamp_s));
    }
    return worst;
  }
};

double uncertaintyOf(const Bench& bench, int count) {
  const auto seen = bench.sightings(count);
  const auto fit = fitCameraClock(seen, bench.options());
  return fit.clock ? fit.clock->uncertaintyAt_s(fit.clock->referenceStamp_s()) : 1.0;
}

struct ClockCase {
  const char* name;
  double share_error;
  double jitter_s;
  bool one_wrong;
};

class CameraClockCoverage : public testing::TestWithParam<ClockCase> {};

TEST_P(CameraClockCoverage, HoldsTheTruthOverManySeeds) {
  const ClockCase& test_case = GetParam();
  constexpr int kSeeds = 400;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const CounterRandom random(seed, 9);
    Bench bench;
    bench.seed = seed;
    bench.share_error = test_case.share_error;
    bench.jitter_s = test_case.jitter_s;
    bench.offset_s = 0.2 * (random.uniform(0) - 0.5);
    bench.drift = 400e-6 * (2.0 * random.uniform(1) - 1.0);
    auto seen = bench.sightings(24);
    if (test_case.one_wrong) {  // The wrong sighting is off by anything from hardly to plainly.
      const auto which = static_cast<std::size_t>(random.bits(2) % seen.size());
      seen[which].edge_s += bench.period_s * 3.0 * (2.0 * random.uniform(3) - 1.0);
    }
    const auto fit = fitCameraClock(seen, bench.options());
    ASSERT_TRUE(fit.clock) << seed << ": " << fit.why_not;
    EXPECT_LE(bench.worstShare(*fit.clock, seen), 1.0 + 1e-9) << seed;
    EXPECT_LE(std::abs(fit.clock->line().drift - bench.drift), fit.clock->driftUncertainty()) << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(CameraClock, CameraClockCoverage,
                         testing::Values(ClockCase{"seenOrNot", 0.0, 50e-6, false},
                                         ClockCase{"seenOrNotOneWrong", 0.0, 50e-6, true},
                                         ClockCase{"shares", 0.05, 50e-6, false},
                                         ClockCase{"sharesOneWrong", 0.05, 50e-6, true},
                                         ClockCase{"muchJitter", 0.05, 2e-3, true},
                                         ClockCase{"noJitter", 0.05, 0.0, true}),
                         [](const auto& test) { return test.param.name; });

TEST(CameraClock, KnowsTheBetterTheMoreItSees) {
  Bench bench;
  bench.jitter_s = 0.0;
  bench.unseen_share = 0.0;
  const double few_s = uncertaintyOf(bench, 12);
  const double many_s = uncertaintyOf(bench, 240);
  EXPECT_LT(few_s, bench.period_s);
  EXPECT_LT(many_s, few_s / 5.0);  // The gaps of n random phases are as 1 / n.
}

// The gain depends on the number of edges that fall into an exposure: at least half of the seeds show it.
TEST(CameraClock, KnowsFarMoreByTheShareOfLight) {
  std::vector<double> by_share_s;
  for (std::uint64_t seed = 1; seed <= 21; ++seed) {
    Bench bench;
    bench.seed = seed;
    const double by_sight_s = uncertaintyOf(bench, 40);
    bench.share_error = 0.02;
    by_share_s.push_back(uncertaintyOf(bench, 40));
    EXPECT_LT(by_share_s.back(), by_sight_s) << seed;
  }
  std::ranges::nth_element(by_share_s, by_share_s.begin() + 10);
  const Bench bench;
  EXPECT_LT(by_share_s[10], bench.exposure_s * 0.02 + bench.jitter_s);  // The bound of one sighting.
}

// Least squares would not notice 200 sightings that all say the same.
TEST(CameraClock, IsNotFooledByALightInStepWithTheFrames) {
  Bench bench;
  bench.drift = 0.0;
  std::vector<EdgeSighting> seen;
  for (std::uint64_t i = 0; i < 200; ++i) seen.push_back(bench.sight(1 + 50 * i, 0.6));
  auto options = bench.options();
  const auto fit = fitCameraClock(seen, options);
  ASSERT_TRUE(fit.clock) << fit.why_not;
  EXPECT_LE(bench.worstShare(*fit.clock, seen), 1.0);
  EXPECT_GT(fit.clock->uncertaintyAt_s(seen.front().lit_stamp_s), (bench.period_s - bench.exposure_s) / 2.0);
  options.max_uncertainty_s = 1e-3;
  const auto strict = fitCameraClock(seen, options);
  EXPECT_FALSE(strict.clock);
  EXPECT_THAT(strict.why_not, HasSubstr("same place of a frame"));
}

TEST(CameraClock, NamesAPlainlyWrongSighting) {
  const Bench bench;
  auto seen = bench.sightings(60);
  seen[17].edge_s += 5.0 * bench.period_s;
  const auto fit = fitCameraClock(seen, bench.options());
  ASSERT_TRUE(fit.clock) << fit.why_not;
  EXPECT_EQ(fit.suspects, std::vector<std::size_t>{17});
}

TEST(CameraClock, SaysThatTwoPlainlyWrongOnesAreTooMany) {
  const Bench bench;
  auto seen = bench.sightings(60);
  seen[17].edge_s += 5.0 * bench.period_s;
  seen[40].edge_s -= 5.0 * bench.period_s;
  const auto fit = fitCameraClock(seen, bench.options());
  EXPECT_FALSE(fit.clock);
  EXPECT_THAT(fit.why_not, HasSubstr("contradict each other"));
}

TEST(CameraClock, OfThreeWithOneWrongTellsThatAnyMayBe) {
  const Bench bench;
  auto seen = bench.sightings(3);
  seen[1].edge_s += 50.0 * bench.period_s;
  auto options = bench.options();
  options.max_uncertainty_s = 10.0;
  const auto fit = fitCameraClock(seen, options);
  ASSERT_TRUE(fit.clock) << fit.why_not;
  EXPECT_THAT(fit.suspects, Contains(1U));
  EXPECT_LE(bench.worstShare(*fit.clock, seen), 1.0);
}

TEST(CameraClock, RefusesTooFewSightings) {
  const Bench bench;
  EXPECT_THAT(fitCameraClock(bench.sightings(2), bench.options()).why_not, HasSubstr("2 sightings"));
  EXPECT_FALSE(fitCameraClock({}, bench.options()).clock);
}

TEST(CameraClock, TakesOffTheDelayOfTheRow) {
  const Bench bench;
  auto seen = bench.sightings(40);
  const auto plain = fitCameraClock(seen, bench.options());
  for (EdgeSighting& one : seen) {
    one.row_delay_s = 4e-3;
    one.edge_s += 4e-3;
  }
  const auto rolling = fitCameraClock(seen, bench.options());
  ASSERT_TRUE(plain.clock && rolling.clock);
  EXPECT_NEAR(rolling.clock->line().offset_s, plain.clock->line().offset_s, 1e-9);
}

TEST(CameraClock, GrowsUncertainBeyondItsSightings) {
  const Bench bench;
  const auto seen = bench.sightings(40);
  const auto fit = fitCameraClock(seen, bench.options());
  ASSERT_TRUE(fit.clock);
  EXPECT_GT(fit.clock->uncertaintyAt_s(1000.0), 3.0 * fit.clock->uncertaintyAt_s(50.0));
}

TEST(CameraClock, SaysWhichSightingIsNone) {
  const Bench bench;
  const auto why = [&](auto&& spoil) {
    auto seen = bench.sightings(5);
    spoil(seen[3]);
    const auto fit = fitCameraClock(seen, bench.options());
    EXPECT_FALSE(fit.clock);
    return fit.why_not;
  };
  EXPECT_THAT(why([](EdgeSighting& s) { s.edge_s = std::nan(""); }), HasSubstr("sighting 3 has a time"));
  EXPECT_THAT(why([](EdgeSighting& s) { s.dark_stamp_s = s.lit_stamp_s; }), HasSubstr("not after its dark"));
  EXPECT_THAT(why([](EdgeSighting& s) { s.lit_share = 1.2; }), HasSubstr("share of light"));
}

TEST(CameraClock, ListsAllOptionsOutOfRange) {
  try {
    (void)fitCameraClock({}, {.exposure_s = 0.0,
                              .stamp_jitter_s = -1.0,
                              .edge_error_s = std::nan(""),
                              .unseen_share = 2.0,
                              .share_error = -0.1,
                              .max_drift = 1.0,
                              .max_uncertainty_s = 0.0});
    FAIL();
  } catch (const std::invalid_argument& error) {
    for (const char* name : {"exposure_s", "stamp_jitter_s", "edge_error_s", "unseen_share", "share_error",
                             "max_drift", "max_uncertainty_s"})
      EXPECT_THAT(error.what(), HasSubstr(name));
  }
  EXPECT_THROW(CameraClock(0.0, {}), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::camera
