// SPDX-License-Identifier: Apache-2.0
#include "twin/signal/level_tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "twin/base/random.h"

namespace kerfbench::twin {
namespace {

constexpr double kTickS = 1.0 / 16e6;
using Change = std::pair<double, bool>;

std::vector<Change> randomChanges(int count, double longest_ticks) {
  const CounterRandom random(3, 5);
  std::vector<Change> changes;
  double ticks = 0.0;
  for (int i = 0; i < count; ++i) {
    ticks += 1.0 + std::floor(longest_ticks * random.uniform(static_cast<std::uint64_t>(i)));
    changes.emplace_back(ticks * kTickS, i % 2 == 0);
  }
  return changes;
}

double bruteMean(const std::vector<Change>& changes, double begin_s, double end_s) {
  double high_s = 0.0;
  for (std::size_t i = 0; i + 1 < changes.size(); i += 2) {
    high_s += std::max(0.0, std::min(end_s, changes[i + 1].first) - std::max(begin_s, changes[i].first));
  }
  return high_s / (end_s - begin_s);
}

TEST(LevelTracker, ItsMeanIsTheShareOfHighTimeForAnyChanges) {
  for (const double longest : {40.0, 300.0, 5000.0}) {
    const auto changes = randomChanges(10000, longest);
    LevelTracker all_known;
    LevelTracker as_it_comes;
    for (const auto& [time_s, level] : changes) all_known.set(time_s, level);
    std::size_t next = 0;
    for (int i = 0; (i + 1) * 10e-6 < changes.back().first && i < 2000; ++i) {
      const double begin_s = i * 10e-6;
      const double end_s = (i + 1) * 10e-6;
      while (next < changes.size() && changes[next].first <= end_s) {
        as_it_comes.set(changes[next].first, changes[next].second);
        ++next;
      }
      const double mean = all_known.meanOver(begin_s, end_s);
      ASSERT_NEAR(mean, bruteMean(changes, begin_s, end_s), 1e-9) << i;
      ASSERT_EQ(mean, as_it_comes.meanOver(begin_s, end_s));
    }
  }
}

TEST(LevelTracker, KnowsWhenThePinChangesNext) {
  LevelTracker tracker;
  EXPECT_TRUE(std::isinf(tracker.nextChange_s()));
  tracker.set(1.0, true);
  tracker.set(1.5, true);
  tracker.set(2.0, false);
  EXPECT_EQ(tracker.nextChange_s(), 1.0);
  (void)tracker.meanOver(0.0, 1.0);
  EXPECT_EQ(tracker.nextChange_s(), 1.0);
  (void)tracker.meanOver(1.0, 1.25);
  EXPECT_EQ(tracker.nextChange_s(), 2.0);
  (void)tracker.meanOver(1.25, 4.0);
  EXPECT_TRUE(std::isinf(tracker.nextChange_s()));
  tracker.set(5.0, true);
  EXPECT_EQ(tracker.nextChange_s(), 5.0);
}

TEST(LevelTracker, IsLowUntilItIsTold) {
  LevelTracker tracker;
  EXPECT_EQ(tracker.meanOver(0.0, 1.0), 0.0);
}

}  // namespace
}  // namespace kerfbench::twin
