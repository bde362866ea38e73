// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware_under_test/planner/motion/jerk_profile.h"
#include "firmware_under_test/planner/motion/speed_profile.h"

namespace kerfbench::planner {
namespace {

/// Shares of the highest speed at a border of runs that are tried. The last is a stop, which always has a
/// solution: between two stops a run may take as long as it likes.
constexpr double kLadder[] = {1.0,  0.98, 0.96, 0.93, 0.9,  0.86, 0.82, 0.77,
                              0.72, 0.65, 0.57, 0.47, 0.35, 0.2,  0.0};
constexpr double kRounding = 1e-9;
constexpr int kNever = std::numeric_limits<int>::max();

/// Speeds at one border, falling.
std::vector<double> ladderBelow(double highest_mm_s) {
  if (highest_mm_s <= 0.0) return {0.0};
  std::vector<double> rungs;
  for (const double share : kLadder) rungs.push_back(share * highest_mm_s);
  return rungs;
}

/// Speeds that the joints of runs admit, the first and the last border being stops.
std::vector<double> jointSpeeds(std::span<const std::vector<Segment>> runs, const std::vector<bool>& rests,
                                const FlowLimits& limits) {
  std::vector<double> most(runs.size() + 1, 0.0);
  for (std::size_t i = 1; i < runs.size(); ++i) {
    if (rests[i]) continue;
    const Segment& before = runs[i - 1].back();
    const Segment& after = runs[i].front();
    most[i] = std::min(jointSpeed(before, after, speedLimitsOf(limits, before.jump)),
                       jointSpeed(before, after, speedLimitsOf(limits, after.jump)));
  }
  return most;
}

/// Highest speeds at the borders of runs: a pass forward and one backward.
template <typename Profile>
std::vector<double> borderSpeeds(const std::vector<Profile>& profiles, const std::vector<double>& most) {
  std::vector<double> highest(profiles.size() + 1, 0.0);
  for (std::size_t i = 0; i + 1 < profiles.size(); ++i) {
    const double cap = std::min(most[i + 1], profiles[i + 1].firstCap());
    highest[i + 1] = std::min(cap, profiles[i].fastestFrom(highest[i]).back());
  }
  for (std::size_t i = profiles.size(); i-- > 0;) {
    highest[i] = std::min(highest[i], profiles[i].fastestTo(highest[i + 1]).front());
  }
  return highest;
}

/// Costs of one run between two borders, for each pair of rungs.
template <typename Profile>
class Crossing {
 public:
  Crossing(const Profile& profile, const std::vector<double>& from, const std::vector<double>& to)
      : profile_(profile), from_(from), to_(to) {
    for (const double v : from) {
      fast_from_.push_back(profile.fastestFrom(v));
      slow_from_.push_back(profile.slowestFrom(v));
    }
    for (const double v : to) {
      fast_to_.push_back(profile.fastestTo(v));
      slow_to_.push_back(profile.slowestTo(v));
    }
  }

  /// Lower bound of the periods for all pairs of rungs.
  int leastPeriods(double period_s) {
    join(0, 0);
    return std::max(
        1, static_cast<int>(std::ceil(std::min(profile_.shortestS(fast_) / period_s, 1e8) - kRounding)));
  }
  /// Fewest whole periods, or kNever.
  int periods(std::size_t a, std::size_t b, double period_s) {
    join(a, b);
    if (fast_.front() < from_[a] * (1.0 - kRounding) || fast_.back() < to_[b] * (1.0 - kRounding))
      return kNever;
    for (std::size_t i = 0; i < fast_.size(); ++i) {
      if (slow_[i] > fast_[i] * (1.0 + kRounding)) return kNever;
    }
    const double count = std::max(1.0, std::ceil(profile_.shortestS(fast_) / period_s - kRounding));
    if (!(count < 1e8) || !profile_.canTake(slow_, count * period_s)) return kNever;
    return static_cast<int>(count);
  }

  std::vector<double> stations(std::size_t a, std::size_t b, int periods, double period_s) {
    join(a, b);
    return profile_.stations(slow_, fast_, periods, period_s);
  }

 private:
  void join(std::size_t a, std::size_t b) {
    fast_.resize(fast_from_[a].size());
    slow_.resize(fast_.size());
    for (std::size_t i = 0; i < fast_.size(); ++i) {
      fast_[i] = std::min(fast_from_[a][i], fast_to_[b][i]);
      slow_[i] = std::max(slow_from_[a][i], slow_to_[b][i]);
    }
  }

  const Profile& profile_;
  const std::vector<double>& from_;
  const std::vector<double>& to_;
  std::vector<typename Profile::Speeds> fast_from_, slow_from_, fast_to_, slow_to_;
  typename Profile::Speeds fast_, slow_;
};

/// Cheapest plan up to one rung.
struct Best {
  int total{kNever};
  int periods{};       ///< Periods of the run that ends here.
  std::size_t from{};  ///< Rung before it.
};

template <typename Profile>
std::vector<std::vector<double>> planWith(std::span<const std::vector<Segment>> runs,
                                          const std::vector<bool>& rests, const FlowLimits& limits) {
  std::vector<Profile> profiles;
  for (const std::vector<Segment>& run : runs) profiles.emplace_back(run, limits);
  const std::vector<double> highest = borderSpeeds(profiles, jointSpeeds(runs, rests, limits));
  std::vector<std::vector<double>> ladders;
  for (const double v : highest) ladders.push_back(ladderBelow(v));

  std::vector<Crossing<Profile>> crossings;
  std::vector<std::vector<Best>> bests{{Best{.total = 0}}};
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    crossings.emplace_back(profiles[i], ladders[i], ladders[i + 1]);
    bests.emplace_back(ladders[i + 1].size());
    const int least = crossings[i].leastPeriods(limits.period_s);
    for (std::size_t b = 0; b < ladders[i + 1].size(); ++b) {
      Best& best = bests.back()[b];
      for (std::size_t a = 0; a < ladders[i].size(); ++a) {
        const int before = bests[i][a].total;
        if (before == kNever || before + least >= best.total) continue;
        const int periods = crossings[i].periods(a, b, limits.period_s);
        if (periods == kNever || before + periods >= best.total) continue;
        best = {before + periods, periods, a};
      }
    }
  }
  if (bests.back()[0].total == kNever) return {};
  std::vector<std::vector<double>> stations(profiles.size());
  std::size_t rung = 0;
  for (std::size_t i = profiles.size(); i-- > 0;) {
    const Best& best = bests[i + 1][rung];
    stations[i] = crossings[i].stations(best.from, rung, best.periods, limits.period_s);
    rung = best.from;
  }
  return stations;
}

}  // namespace

std::vector<std::vector<double>> planFlow(std::span<const std::vector<Segment>> runs,
                                          const std::vector<bool>& rests, const FlowLimits& limits) {
  return limits.jerk_mm_s3 > 0.0 ? planWith<JerkProfile>(runs, rests, limits)
                                 : planWith<SpeedProfile>(runs, rests, limits);
}

}  // namespace kerfbench::planner
