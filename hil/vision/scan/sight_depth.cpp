// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/scan/sight_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "twin/base/statistics.h"

namespace kerfbench::vision {
namespace {

using Eigen::Index;

// Shares of the thickness. Through: between upright walls (a half) and the bottom (all), each as likely, with
// a margin for walls that lean the other way. Shallow: from the face down to half of a deep groove.
constexpr SightDepth kThroughShare{0.7, 0.2};
constexpr SightDepth kShallowShare{0.35, 0.2};
/// The depth is not quite the same at all angles: walls that lean by less than the line of sight hide more.
constexpr double kModelShare = 0.04;
constexpr double kLeastTable_mm = 1e-4;  ///< A table is never told to be better.
constexpr double kLeastPair_mm = 3e-4;  ///< Grid of pixels and model of the flanks; no scatter tells of them.
constexpr double kOutlierSigmas = 5.0;

struct Solution {
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
};

Index formIndex(const SightPair& pair) { return static_cast<Index>(pair.form); }

/// How one pair depends on the depths and the tiles' shifts.
Eigen::VectorXd rowOf(const SightPair& pair, Index unknowns) {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(unknowns);
  // A feature at the depth d is seen in the plane of the marks d · slope nearer to the foot of the camera.
  row[formIndex(pair)] = -pair.slope;
  const auto shift = [&](std::size_t tile, double sign) {
    row.segment<2>(static_cast<Index>(kKerfForms + 2 * tile)) += sign * pair.normal;
  };
  shift(pair.other, 1.0);
  shift(pair.tile, -1.0);
  return row;
}

Solution solve(const std::vector<const SightPair*>& pairs, std::size_t tiles, const SightDepths& expected,
               double table_mm) {
  const auto unknowns = static_cast<Index>(kKerfForms + 2 * tiles);
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
  for (Index i = 0; i < unknowns; ++i) {
    const bool is_depth = i < static_cast<Index>(kKerfForms);
    const SightDepth known = is_depth ? expected.at(static_cast<std::size_t>(i)) : SightDepth{0.0, table_mm};
    normal(i, i) = 1.0 / (known.sigma_mm * known.sigma_mm);
    right[i] = known.mm * normal(i, i);
  }
  for (const SightPair* pair : pairs) {
    const Eigen::VectorXd row = rowOf(*pair, unknowns);
    const double sigma_mm = std::hypot(pair->sigma_mm, kLeastPair_mm);
    const double weight = 1.0 / (sigma_mm * sigma_mm);
    normal.noalias() += weight * row * row.transpose();
    right.noalias() += weight * pair->apart_mm * row;
  }
  const Eigen::LDLT<Eigen::MatrixXd> solver(normal);
  return {solver.solve(right), solver.solve(Eigen::MatrixXd::Identity(unknowns, unknowns))};
}

double missOf(const SightPair& pair, const Solution& solution) {
  return pair.apart_mm - rowOf(pair, solution.value.size()).dot(solution.value);
}

/// Pairs within a few sigmas of the fit, by their scatter about it or what their noise says, the larger.
std::vector<const SightPair*> fitting(const std::vector<const SightPair*>& pairs, const Solution& solution) {
  std::vector<double> sizes;
  for (const SightPair* pair : pairs) sizes.push_back(std::abs(missOf(*pair, solution)));
  constexpr double kNormalMedian = 0.6745;  // Median of |x| of a standard normal value.
  const double scatter_mm = upperMedianIn(sizes) / kNormalMedian;
  std::vector<const SightPair*> kept;
  for (const SightPair* pair : pairs) {
    const double limit_mm = kOutlierSigmas * std::max({scatter_mm, pair->sigma_mm, kLeastPair_mm});
    if (std::abs(missOf(*pair, solution)) <= limit_mm) kept.push_back(pair);
  }
  return kept;
}

}  // namespace

KerfForm formOf(dieline::Process process) {
  const bool through = process == dieline::Process::kCut || process == dieline::Process::kPerforation;
  return through ? KerfForm::kThrough : KerfForm::kShallow;
}

SightDepths expectedDepths(double thickness_mm) {
  const auto depth = [&](const SightDepth& share) {
    return SightDepth{share.mm * thickness_mm, share.sigma_mm * thickness_mm};
  };
  return {depth(kThroughShare), depth(kShallowShare)};
}

SightFit sightDepths(const std::vector<SightPair>& pairs, std::size_t tiles, double thickness_mm,
                     double table_sigma_mm) {
  SightFit fit{expectedDepths(thickness_mm), std::numeric_limits<double>::quiet_NaN()};
  if (!(thickness_mm > 0.0) || pairs.empty()) return fit;
  std::vector<const SightPair*> used;
  for (const SightPair& pair : pairs) used.push_back(&pair);
  const SightDepths expected = fit.depths;
  const double table_mm = std::max(table_sigma_mm, kLeastTable_mm);
  Solution solution = solve(used, tiles, expected, table_mm);
  used = fitting(used, solution);
  solution = solve(used, tiles, expected, table_mm);
  for (std::size_t form = 0; form < kKerfForms; ++form) {
    const auto i = static_cast<Index>(form);
    fit.depths.at(form) = {solution.value[i],
                           std::hypot(std::sqrt(solution.covariance(i, i)), kModelShare * thickness_mm)};
  }
  const auto shifts = solution.value.tail(static_cast<Index>(2 * tiles));
  fit.misfit_mm = std::sqrt(shifts.squaredNorm() / static_cast<double>(shifts.size()));
  return fit;
}

}  // namespace kerfbench::vision
