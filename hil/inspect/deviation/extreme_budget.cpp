// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/extreme_budget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/inspect/deviation/error_model.h"
#include "hil/inspect/deviation/exponentials.h"
#include "hil/inspect/deviation/largest_of_all.h"
#include "hil/inspect/deviation/normal_cdf.h"

namespace kerfbench::inspect {
namespace {

constexpr double kFar = 6.5;                   // Sigmas: no value comes so far.
constexpr std::size_t kSteps = kExponentials;  // Steps of the integral over the angle.
constexpr int kGrid = 160;                     // Points of the distribution.

/// A standard normal value that is asked about, and the chance to lie below it.
struct Quantile {
  explicit Quantile(double z_) : z(z_), below(normalCdf(z_)) {}
  double z, below;
};

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
  [[nodiscard]] double chance(const Quantile& a, const Quantile& b) const {
    std::array<double, kSteps> density{};
    for (std::size_t k = 0; k < kSteps; ++k)
      density[k] = -(a.z * a.z + b.z * b.z - 2.0 * a.z * b.z * cosine_[k]) * per_square_[k];
    toExponentials(density);
    double sum = 0.0;
    for (const double d : density) sum += d;
    return std::max(a.below - b.below, 0.0) + sum * weight_;
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

/// Goes through the points of a line for one height w, in their order.
class Hazards {
 public:
  explicit Hazards(double w) : w_(w) {}

  /// -log of the chance that this point stays below w, given that the one before does.
  [[nodiscard]] double next(const Side& s) {
    const double z = (w_ - s.height) / s.sigma;
    const std::optional<Quantile> before = std::exchange(last_, std::nullopt);
    if (z > kFar) return 0.0;
    last_.emplace(z);
    if (s.first) return -std::log(std::max(last_->below, kLeast));
    const Quantile below = before ? *before : Quantile((w_ - s.height_before) / s.sigma_before);
    const double share = s.with_before.chance(below, *last_) / std::max(below.below, kLeast);
    return -std::log1p(-std::clamp(share, 0.0, 1.0 - 1e-9));
  }

 private:
  static constexpr double kLeast = 1e-12;
  double w_;
  std::optional<Quantile> last_;  ///< The last point, unless it lies far below.
};

/// Sum over all points, or some sum beyond which no chance is left.
double totalHazard(const std::vector<Side>& sides, double w) {
  constexpr double kCertain = 60.0;
  Hazards hazards(w);
  double sum = 0.0;
  for (const Side& s : sides) {
    sum += hazards.next(s);
    if (sum > kCertain) break;
  }
  return sum;
}

/// How the places of the shared errors of one line lie in those of all.
class SharedIndex {
 public:
  SharedIndex(const std::vector<ExtremeHeights>& lines, Eigen::Index tiles) : tiles_(tiles) {
    for (const ExtremeHeights& line : lines) {
      place_.try_emplace(line.unit, static_cast<Eigen::Index>(place_.size()) * ReadingLine::kPose);
      if (line.camera >= 0) camera_ = line.camera;
    }
  }
  [[nodiscard]] Eigen::Index poses() const {
    return static_cast<Eigen::Index>(place_.size()) * ReadingLine::kPose;
  }
  /// Number of all.
  [[nodiscard]] Eigen::Index size() const { return poses() + tiles_ + camera_; }
  /// What moves a line, as the places of all.
  [[nodiscard]] std::vector<std::pair<Eigen::Index, double>> spread(const ExtremeLine& line,
                                                                    const Eigen::RowVectorXd& own) const {
    std::vector<std::pair<Eigen::Index, double>> all;
    for (Eigen::Index k = 0; k < ReadingLine::kPose; ++k)
      all.emplace_back(place_.at(line.unit) + k, own[ReadingLine::kLine + k]);
    const auto tiles = static_cast<Eigen::Index>(line.tiles.size());
    for (Eigen::Index k = 0; k < tiles; ++k)
      all.emplace_back(poses() + line.tiles[static_cast<std::size_t>(k)], own[ReadingLine::kOwn + k]);
    for (Eigen::Index k = 0; k < camera_; ++k)
      all.emplace_back(poses() + tiles_ + k, own[ReadingLine::kOwn + tiles + k]);
    return all;
  }

 private:
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
  Hazards hazards(median);
  for (const Side& s : sides) shared += sign * hazards.next(s) / total * s.point->shared;
  return Largest{mean, std::max(square - mean * mean, 0.0) + shared.squaredNorm(),
                 index.spread(line, shared)};
}

/// Where the parts of a line go farthest, to the one side and the other, if that may be the farthest of all.
std::vector<Largest> farthestOf(const std::vector<ExtremeLine>& parts, double floor,
                                const SharedIndex& index) {
  std::vector<Largest> farthest;
  for (const ExtremeLine& part : parts) {
    for (const double sign : {1.0, -1.0}) {
      if (std::optional<Largest> side = farthestToSide(part, sign, floor, index))
        farthest.push_back(std::move(*side));
    }
  }
  return farthest;
}

}  // namespace

void ExtremeHeights::add(const ExtremeLine& part) {
  unit = part.unit;
  for (const ExtremePoint& p : part.points) {
    seen = std::max(seen, std::abs(p.seen));
    likely = std::max(likely, std::abs(p.likely));
    floor = std::max(floor, std::abs(p.seen) - kFar * std::hypot(p.sigma, p.shared.norm()));
    reach = std::max(reach, std::abs(p.seen) + kFar * p.sigma);
  }
  if (!part.points.empty()) {
    camera =
        part.points.front().shared.size() - ReadingLine::kOwn - static_cast<Eigen::Index>(part.tiles.size());
  }
}

ExtremeBudget extremeBudget(const std::vector<ExtremeHeights>& heights, const PartsOfLine& parts,
                            Eigen::Index tiles, int threads) {
  double highest_seen = 0.0;
  double highest_likely = 0.0;
  double floor = -std::numeric_limits<double>::infinity();
  for (const ExtremeHeights& line : heights) {
    highest_seen = std::max(highest_seen, line.seen);
    highest_likely = std::max(highest_likely, line.likely);
    floor = std::max(floor, line.floor);
  }
  const SharedIndex index(heights, tiles);
  std::vector<std::vector<Largest>> of_line(heights.size());
  base::forEachIndex(of_line.size(), threads, [&](std::size_t l) {
    if (heights[l].reach > floor) of_line[l] = farthestOf(parts(l), floor, index);
  });
  std::vector<Largest> candidates;
  for (std::vector<Largest>& some : of_line) std::ranges::move(some, std::back_inserter(candidates));
  of_line.clear();
  ExtremeBudget budget;
  if (candidates.empty()) return budget;
  const LargestOfAll all = largestOfAll(candidates, index.size());
  budget.extreme_bias = all.mean - highest_seen;
  budget.smoothing_bias = highest_seen - highest_likely;
  budget.u_pose = all.gradient.head(index.poses()).norm();
  budget.u_table = all.gradient.segment(index.poses(), tiles).norm();
  budget.u_camera = all.gradient.tail(all.gradient.size() - index.poses() - tiles).norm();
  budget.u_noise = std::sqrt(std::max(all.variance - all.gradient.squaredNorm(), 0.0));
  return budget;
}

ExtremeBudget extremeBudget(const std::vector<ExtremeLine>& lines, Eigen::Index tiles, int threads) {
  std::vector<ExtremeHeights> heights(lines.size());
  for (std::size_t l = 0; l < lines.size(); ++l) heights[l].add(lines[l]);
  return extremeBudget(
      heights, [&](std::size_t l) { return std::vector{lines[l]}; }, tiles, threads);
}

}  // namespace kerfbench::inspect
