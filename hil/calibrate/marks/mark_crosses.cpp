// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>

#include "hil/calibrate/marks/mark_pattern.h"
#include "hil/calibrate/marks/mark_strokes.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::Vector2d;

constexpr double kScale = 0.2;  // Largest error of scale of a head.
/// Largest sine of the angle of arms to each other and to the line through both.
constexpr double kAskew = 0.12;
constexpr double kSquare = 0.8;  // Least sine of the angle between the two lines.
constexpr double kMeet = 0.12;   // Largest distance of the two lines' middles, in half sizes.
constexpr double kSlim = 0.5;    // Largest width of an arm over its length.
constexpr double kArm = 1.0 - kArmFrom;
constexpr double kArmMiddle = 0.5 * (1.0 + kArmFrom);

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Two arms of one line.
struct Pair {
  std::size_t a{}, b{};
  Vector2d middle_mm{Vector2d::Zero()};
  Vector2d unit_mm{Vector2d::Zero()};  ///< From the middle towards b, for half a size of 1.
};

std::vector<Pair> pairsOf(const std::vector<Stroke>& arms, double half_mm) {
  const double expected_mm = 2.0 * kArmMiddle * half_mm;
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < arms.size(); ++i) {
    const Vector2d along = arms[i].half_mm.normalized();
    // In order of x.
    for (std::size_t j = i + 1; j < arms.size(); ++j) {
      const Vector2d way = arms[j].p_T_mm - arms[i].p_T_mm;
      if (way.x() > (1.0 + kScale) * expected_mm) break;
      if (std::abs(way.norm() / expected_mm - 1.0) > kScale) continue;
      if (std::abs(cross(along, arms[j].half_mm.normalized())) > kAskew) continue;
      if (std::abs(cross(along, way.normalized())) > kAskew) continue;
      pairs.push_back({i, j, 0.5 * (arms[i].p_T_mm + arms[j].p_T_mm), 0.5 / kArmMiddle * way});
    }
  }
  return pairs;
}

/// Two pairs that may be a mark.
struct Match {
  std::size_t first{}, second{};
  double misfit{};
};

std::vector<Match> matchesOf(const std::vector<Pair>& pairs, double half_mm) {
  std::vector<Match> matches;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      const double apart = (pairs[i].middle_mm - pairs[j].middle_mm).norm() / half_mm;
      if (apart > kMeet) continue;
      const double sine = cross(pairs[i].unit_mm.normalized(), pairs[j].unit_mm.normalized());
      if (std::abs(sine) < kSquare) continue;
      matches.push_back({i, j, apart + 1.0 - std::abs(sine)});
    }
  }
  std::ranges::stable_sort(matches, {}, &Match::misfit);
  return matches;
}

Cross crossOf(const std::vector<Stroke>& arms, const Pair& first, Pair second) {
  if (cross(first.unit_mm, second.unit_mm) < 0.0) {
    std::swap(second.a, second.b);
    second.unit_mm = -second.unit_mm;
  }
  Cross whole;
  whole.p_T_mm = 0.5 * (first.middle_mm + second.middle_mm);
  whole.arms = {arms[first.b], arms[second.b], arms[first.a], arms[second.a]};
  whole.axes_mm << first.unit_mm, second.unit_mm;
  return whole;
}

}  // namespace

bool isArm(const Stroke& stroke, double size_mm) {
  const double length_mm = 2.0 * stroke.half_mm.norm();
  // The kerf rounds both ends by half of its width.
  const double drawn_mm = length_mm - stroke.width_mm;
  return std::abs(drawn_mm / (0.5 * kArm * size_mm) - 1.0) < kScale + 0.05 &&
         stroke.width_mm < kSlim * length_mm;
}

Crosses assembleCrosses(const std::vector<Stroke>& arms, double size_mm) {
  const double half_mm = 0.5 * size_mm;
  const std::vector<Pair> pairs = pairsOf(arms, half_mm);
  Crosses crosses;
  std::set<std::size_t> used;
  const auto isFree = [&](const Pair& pair) { return !used.contains(pair.a) && !used.contains(pair.b); };
  const auto use = [&](const Pair& pair) { used.insert({pair.a, pair.b}); };
  for (const Match& match : matchesOf(pairs, half_mm)) {
    const Pair& first = pairs[match.first];
    const Pair& second = pairs[match.second];
    if (!isFree(first) || !isFree(second)) continue;
    use(first);
    use(second);
    crosses.whole.push_back(crossOf(arms, first, second));
  }
  for (const Pair& pair : pairs) {
    if (!isFree(pair)) continue;
    use(pair);
    crosses.broken_T_mm.push_back(pair.middle_mm);
  }
  for (std::size_t i = 0; i < arms.size(); ++i) {
    if (!used.contains(i)) crosses.single.push_back(arms[i]);
  }
  return crosses;
}

}  // namespace kerfbench::calibrate
