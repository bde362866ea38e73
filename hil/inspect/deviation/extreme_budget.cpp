// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/extreme_budget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/SVD>

#include "hil/base/parallel.h"
#include "hil/inspect/deviation/error_model.h"

namespace kerfbench::inspect {
namespace {

constexpr double kFar = 6.5;        // Sigmas: no value comes so far.
constexpr std::size_t kSteps = 8;   // Steps of the integral over the angle.
constexpr int kGrid = 160;          // Points of the distribution.
constexpr int kNodes = 7;           // Nodes each way of the integral over shared errors,
constexpr double kNodePitch = 0.5;  // so many standard deviations apart: what kinks is right to 2 %.

double normalCdf(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

/// P(Z1 <= a, Z2 > b) of normal values of correlation cos(angle).
class Crossing {
 public:
  explicit Crossing(double angle) : weight_(angle / kSteps / (2.0 * std::numbers::pi)) {
    for (std::size_t k = 0; k < kSteps; ++k) {
      const double t = angle * (static_cast<double>(k) + 0.5) / kSteps;
      cosine_[k] = std::cos(t);
      per_square_[k] = 0.5 / (std::sin(t) * std::sin(t));
    }
  }
  [[nodiscard]] double chance(double a, double b) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < kSteps; ++k)
      sum += std::exp(-(a * a + b * b - 2.0 * a * b * cosine_[k]) * per_square_[k]);
    return normalCdf(a) - normalCdf(std::min(a, b)) + sum * weight_;
  }

 private:
  double weight_;
  std::array<double, kSteps> cosine_{}, per_square_{};
};

/// One side of one point: the noise must reach `distance` to lift it above w.
struct Side {
  double height;  ///< Height of the estimate, counted positive towards this side.
  double sigma;
  bool first;  ///< The first of a run of points that matter.
  Crossing with_before;
  const ExtremePoint* point;
  double height_before, sigma_before;  ///< Height and noise of the point before.
};

/// -log of the chance that this point stays below w, given that the one before does.
double hazard(const Side& s, double w) {
  const double z = (w - s.height) / s.sigma;
  if (z > kFar) return 0.0;
  if (s.first) return -std::log(std::max(normalCdf(z), 1e-12));
  const double before = (w - s.height_before) / s.sigma_before;
  const double share = s.with_before.chance(before, z) / std::max(normalCdf(before), 1e-12);
  return -std::log1p(-std::clamp(share, 0.0, 1.0 - 1e-9));
}

std::vector<Side> sidesOf(const std::vector<ExtremePoint>& points, double sign, double least) {
  std::vector<Side> sides;
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
    sides.push_back({height, p.sigma, first, Crossing(angle), &p, height_before, sigma_before});
    broken = false;
  }
  return sides;
}

/// Sum over all points, or some sum beyond which no chance is left.
double totalHazard(const std::vector<Side>& sides, double w) {
  constexpr double kCertain = 60.0;
  double sum = 0.0;
  for (const Side& s : sides) {
    sum += hazard(s, w);
    if (sum > kCertain) break;
  }
  return sum;
}

/// A largest value: normal about `mean`, moved by shared errors by `gradient`, and by others that it shares
/// with no one.
struct Largest {
  double mean{};
  double variance{};            ///< In all.
  Eigen::RowVectorXd gradient;  ///< Gradient by the poses of all units, then by tiles and camera.
};

/// How the places of the shared errors of one line lie in those of all.
class SharedIndex {
 public:
  SharedIndex(const std::vector<ExtremeLine>& lines, Eigen::Index tiles) : tiles_(tiles) {
    for (const ExtremeLine& line : lines) {
      place_.try_emplace(line.unit, static_cast<Eigen::Index>(place_.size()) * ReadingLine::kPose);
      if (!line.points.empty())
        camera_ = line.points.front().shared.size() - ReadingLine::kOwn - tilesOf(line);
    }
  }
  [[nodiscard]] Eigen::Index poses() const {
    return static_cast<Eigen::Index>(place_.size()) * ReadingLine::kPose;
  }
  [[nodiscard]] Eigen::RowVectorXd spread(const ExtremeLine& line, const Eigen::RowVectorXd& own) const {
    Eigen::RowVectorXd all = Eigen::RowVectorXd::Zero(poses() + tiles_ + camera_);
    all.segment<ReadingLine::kPose>(place_.at(line.unit)) =
        own.segment<ReadingLine::kPose>(ReadingLine::kLine);
    for (std::size_t k = 0; k < line.tiles.size(); ++k)
      all[poses() + line.tiles[k]] = own[ReadingLine::kOwn + static_cast<Eigen::Index>(k)];
    all.tail(camera_) = own.tail(camera_);
    return all;
  }

 private:
  static Eigen::Index tilesOf(const ExtremeLine& line) {
    return static_cast<Eigen::Index>(line.tiles.size());
  }

  std::map<int, Eigen::Index> place_;
  Eigen::Index tiles_;
  Eigen::Index camera_{};
};

/// The farthest that one line goes to one side, its left (sign 1) or its right (-1); nullopt if it stays
/// below `floor` whatever its noise does.
std::optional<Largest> farthestToSide(const ExtremeLine& line, double sign, double floor,
                                      const SharedIndex& index) {
  double highest = floor;
  double sigma_most = 0.0;
  double least = floor;
  for (const ExtremePoint& p : line.points) {
    highest = std::max(highest, sign * p.seen);
    sigma_most = std::max(sigma_most, p.sigma);
    least = std::max(least, sign * p.seen - kFar * p.sigma);
  }
  const std::vector<Side> sides = sidesOf(line.points, sign, least);
  const double step = (highest + kFar * sigma_most - least) / kGrid;
  if (sides.empty() || !(step > 0.0)) return std::nullopt;
  // P(max <= w) on a grid; mean and variance are integrals of its complement.
  double mean = least;
  double square = least * least;
  double median = highest;
  double last = 0.0;
  for (int k = 0; k < kGrid; ++k) {
    const double w = least + (k + 0.5) * step;
    const double inside = std::exp(-totalHazard(sides, w));
    mean += (1.0 - inside) * step;
    square += 2.0 * w * (1.0 - inside) * step;
    if (last < 0.5 && inside >= 0.5) median = w;
    last = inside;
  }
  const double total = std::max(totalHazard(sides, median), 1e-300);
  Eigen::RowVectorXd shared = Eigen::RowVectorXd::Zero(line.points.front().shared.size());
  for (const Side& s : sides) shared += sign * hazard(s, median) / total * s.point->shared;
  return Largest{mean, std::max(square - mean * mean, 0.0) + shared.squaredNorm(),
                 index.spread(line, shared)};
}

/// The larger of two (Clark 1961).
Largest largerOf(const Largest& x, const Largest& y) {
  const double parted = x.variance + y.variance - 2.0 * x.gradient.dot(y.gradient);
  if (!(parted > 0.0)) return x.mean > y.mean ? x : y;
  const double a = std::sqrt(parted);
  const double z = (x.mean - y.mean) / a;
  const double p = normalCdf(z);
  const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
  Largest out;
  out.mean = x.mean * p + y.mean * (1.0 - p) + a * density;
  const double square = (x.mean * x.mean + x.variance) * p + (y.mean * y.mean + y.variance) * (1.0 - p) +
                        (x.mean + y.mean) * a * density;
  out.gradient = p * x.gradient + (1.0 - p) * y.gradient;
  out.variance = std::max(square - out.mean * out.mean, out.gradient.squaredNorm());
  return out;
}

/// The two directions among the shared errors that move the candidates most (columns; orthonormal).
Eigen::MatrixXd mainDirections(const std::vector<Largest>& candidates) {
  const Eigen::Index n = candidates.front().gradient.size();
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(candidates.size()), n);
  for (std::size_t i = 0; i < candidates.size(); ++i)
    rows.row(static_cast<Eigen::Index>(i)) = candidates[i].gradient;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeThinV);
  return svd.matrixV().leftCols(std::min<Eigen::Index>(2, svd.matrixV().cols()));
}

/// Largest of all, given where the errors of the main directions are.
Largest largestGiven(const std::vector<Largest>& candidates, const Eigen::MatrixXd& directions,
                     const Eigen::VectorXd& at) {
  std::optional<Largest> all;
  std::vector<Largest> moved;
  for (const Largest& candidate : candidates) {
    const Eigen::RowVectorXd along = candidate.gradient * directions;
    moved.push_back({candidate.mean + along.dot(at), candidate.variance - along.squaredNorm(),
                     candidate.gradient - along * directions.transpose()});
  }
  std::ranges::stable_sort(moved, std::greater{}, &Largest::mean);
  for (const Largest& candidate : moved) all = all ? largerOf(*all, candidate) : candidate;
  return *all;
}

/// Largest of all. An error that lines share makes one side larger by what it takes from the other, and no
/// slope tells that: the two directions that move most are integrated over, the rest is taken as linear.
Largest largestOfAll(const std::vector<Largest>& candidates) {
  const Eigen::MatrixXd directions = mainDirections(candidates);
  const Eigen::Index n = directions.cols();
  Largest all{0.0, 0.0, Eigen::RowVectorXd::Zero(candidates.front().gradient.size())};
  double square = 0.0;
  double weights = 0.0;
  for (int i = -kNodes; i <= kNodes; ++i) {
    for (int k = n < 2 ? 0 : -kNodes; k <= (n < 2 ? 0 : kNodes); ++k) {
      const Eigen::VectorXd at = kNodePitch * Eigen::Vector2d(i, k).head(n);
      const double weight = std::exp(-0.5 * at.squaredNorm());
      const Largest given = largestGiven(candidates, directions, at);
      weights += weight;
      all.mean += weight * given.mean;
      square += weight * (given.mean * given.mean + given.variance);
      // The slope along the main directions, by Stein's lemma.
      all.gradient += weight * (given.gradient + given.mean * (directions * at).transpose());
    }
  }
  all.mean /= weights;
  all.gradient /= weights;
  square /= weights;
  all.variance = std::max(square - all.mean * all.mean, all.gradient.squaredNorm());
  return all;
}

}  // namespace

ExtremeBudget extremeBudget(const std::vector<ExtremeLine>& lines, Eigen::Index tiles, int threads) {
  double highest_seen = 0.0;
  double highest_likely = 0.0;
  double floor = -std::numeric_limits<double>::infinity();
  for (const ExtremeLine& line : lines) {
    for (const ExtremePoint& p : line.points) {
      highest_seen = std::max(highest_seen, std::abs(p.seen));
      highest_likely = std::max(highest_likely, std::abs(p.likely));
      floor = std::max(floor, std::abs(p.seen) - kFar * std::hypot(p.sigma, p.shared.norm()));
    }
  }
  const SharedIndex index(lines, tiles);
  std::vector<std::optional<Largest>> sides(2 * lines.size());
  base::forEachIndex(sides.size(), threads, [&](std::size_t i) {
    sides[i] = farthestToSide(lines[i / 2], i % 2 == 0 ? 1.0 : -1.0, floor, index);
  });
  std::vector<Largest> candidates;
  for (std::optional<Largest>& side : sides) {
    if (side) candidates.push_back(std::move(*side));
  }
  ExtremeBudget budget;
  if (candidates.empty()) return budget;
  const Largest all = largestOfAll(candidates);
  budget.extreme_bias = all.mean - highest_seen;
  budget.smoothing_bias = highest_seen - highest_likely;
  budget.u_pose = all.gradient.head(index.poses()).norm();
  budget.u_table = all.gradient.segment(index.poses(), tiles).norm();
  budget.u_camera = all.gradient.tail(all.gradient.size() - index.poses() - tiles).norm();
  budget.u_noise = std::sqrt(std::max(all.variance - all.gradient.squaredNorm(), 0.0));
  return budget;
}

}  // namespace kerfbench::inspect
