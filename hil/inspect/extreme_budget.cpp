// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/extreme_budget.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace kerfbench::hil {
namespace {

constexpr double kFar = 6.5;  // Sigmas: no value comes so far.
constexpr int kSteps = 8;     // Of the integral over t.
constexpr int kGrid = 160;    // Of the distribution.

double normalCdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

/// One side of one point: the noise must reach `distance` to lift it above w.
struct Side {
  double height;  ///< Of the estimate, counted positive towards this side.
  double sigma;
  double angle;  ///< acos of the correlation with the point before.
  bool first;    ///< Of a run of points that matter.
  double sign;
  const ExtremePoint* point;
  double height_before, sigma_before;  ///< Of the point before.
};

/// P(Z1 <= a, Z2 > b) of normal values of correlation cos(angle).
double crossing(double a, double b, double angle) {
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double t = angle * (k + 0.5) / kSteps;
    const double s = std::sin(t);
    sum += std::exp(-(a * a + b * b - 2.0 * a * b * std::cos(t)) / (2.0 * s * s));
  }
  return normalCdf(a) - normalCdf(std::min(a, b)) + sum * angle / kSteps / (2.0 * std::numbers::pi);
}

/// -log of the chance that this point stays below w, given that the one before does.
double hazard(const Side& s, double w) {
  const double z = (w - s.height) / s.sigma;
  if (z > kFar) return 0.0;
  if (s.first) return -std::log(std::max(normalCdf(z), 1e-12));
  const double before = (w - s.height_before) / s.sigma_before;
  const double share = crossing(before, z, s.angle) / std::max(normalCdf(before), 1e-12);
  return -std::log1p(-std::clamp(share, 0.0, 1.0 - 1e-9));
}

std::vector<Side> sidesOf(const std::vector<ExtremePoint>& points, double least) {
  std::vector<Side> sides;
  for (const double sign : {1.0, -1.0}) {
    bool broken = true;
    for (const ExtremePoint& p : points) {
      const double height = sign * p.seen;
      if (!(height + kFar * p.sigma > least)) {
        broken = true;
        continue;
      }
      const bool first = broken || p.correlation <= 0.0;
      const Side* before = first ? nullptr : &sides.back();
      const double height_before = before != nullptr ? before->height : 0.0;
      const double sigma_before = before != nullptr ? before->sigma : 1.0;
      const double angle = std::acos(std::clamp(p.correlation, 0.0, 1.0));
      sides.push_back({height, p.sigma, angle, first, sign, &p, height_before, sigma_before});
      broken = false;
    }
  }
  return sides;
}

double totalHazard(const std::vector<Side>& sides, double w) {
  double sum = 0.0;
  for (const Side& s : sides) sum += hazard(s, w);
  return sum;
}

}  // namespace

ExtremeBudget extremeBudget(const std::vector<ExtremePoint>& points, Eigen::Index own) {
  ExtremeBudget budget;
  if (points.empty()) return budget;
  double highest_seen = 0.0;
  double highest_likely = 0.0;
  double sigma_most = 0.0;
  double least = 0.0;
  for (const ExtremePoint& p : points) {
    highest_seen = std::max(highest_seen, std::abs(p.seen));
    highest_likely = std::max(highest_likely, std::abs(p.likely));
    sigma_most = std::max(sigma_most, p.sigma);
    least = std::max(least, std::abs(p.seen) - kFar * p.sigma);
  }
  least = std::max(least, 0.0);
  const std::vector<Side> sides = sidesOf(points, least);
  // P(max <= w) on a grid; mean and variance are integrals of its complement.
  const double step = (highest_seen + kFar * sigma_most - least) / kGrid;
  double mean = least;
  double square = least * least;
  double median = highest_seen;
  double last = 0.0;
  for (int k = 0; k < kGrid && step > 0.0; ++k) {
    const double w = least + (k + 0.5) * step;
    const double inside = std::exp(-totalHazard(sides, w));
    mean += (1.0 - inside) * step;
    square += 2.0 * w * (1.0 - inside) * step;
    if (last < 0.5 && inside >= 0.5) median = w;
    last = inside;
  }
  budget.u_noise = std::sqrt(std::max(square - mean * mean, 0.0));
  budget.extreme_bias = mean - highest_seen;
  budget.smoothing_bias = highest_seen - highest_likely;

  const double total = std::max(totalHazard(sides, median), 1e-300);
  std::map<int, Eigen::RowVectorXd> by_group;
  Eigen::RowVectorXd common = Eigen::RowVectorXd::Zero(points.front().shared.size() - own);
  for (const Side& s : sides) {
    const double weight = s.sign * hazard(s, median) / total;
    Eigen::RowVectorXd& mine =
        by_group.try_emplace(s.point->group, Eigen::RowVectorXd::Zero(own)).first->second;
    mine += weight * s.point->shared.head(own);
    common += weight * s.point->shared.tail(common.size());
  }
  double own_square = 0.0;
  for (const auto& [group, g] : by_group) own_square += g.squaredNorm();
  budget.u_own = std::sqrt(own_square);
  budget.u_common = common.norm();
  return budget;
}

}  // namespace kerfbench::hil
