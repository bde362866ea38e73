// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/rigid.h"

#include <cmath>
#include <vector>

#include "hil/calibrate/head/spread.h"
#include "twin/base/statistics.h"

namespace kerfbench::calibrate {
namespace {

Eigen::Isometry2d leastSquares(std::span<const PlacePair> pairs, const std::vector<bool>& used) {
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!used[i]) continue;
    from += pairs[i].first;
    to += pairs[i].second;
    count += 1.0;
  }
  from /= count;
  to /= count;
  double along = 0.0, across = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!used[i]) continue;
    const Eigen::Vector2d a = pairs[i].first - from, b = pairs[i].second - to;
    along += a.dot(b);
    across += a.x() * b.y() - a.y() * b.x();
  }
  const Eigen::Rotation2Dd turn(std::atan2(across, along));
  return Eigen::Translation2d(to - turn * from) * turn;
}

}  // namespace

RigidMotion rigidMotion(std::span<const PlacePair> pairs) {
  constexpr int kPasses = 10;
  constexpr double kFarInMedians = 10.0;
  std::vector<bool> used(pairs.size(), true);
  RigidMotion motion;
  for (int pass = 0; pass < kPasses; ++pass) {
    motion.X = leastSquares(pairs, used);
    std::vector<double> misses;
    for (const PlacePair& pair : pairs) misses.push_back((pair.second - motion.X * pair.first).norm());
    motion.median_miss_mm = upperMedianOf(misses);
    std::vector<bool> next;
    for (const double miss : misses) next.push_back(miss <= kFarInMedians * motion.median_miss_mm);
    if (next == used) break;
    used = next;
  }
  return motion;
}

}  // namespace kerfbench::calibrate
