// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/largest_of_all.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCore>

#include "hil/inspect/deviation/normal_cdf.h"
#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

constexpr int kNodes = 7;           // Nodes each way of the integral over shared errors,
constexpr double kNodePitch = 0.5;  // so many standard deviations apart: what kinks is right to 2 %.
constexpr Eigen::Index kMain = 2;   // Directions that are integrated over.
constexpr Eigen::Index kBlock = 6;  // Directions that are sought at once: those beside speed the search up.
constexpr int kMostSearches = 300;
constexpr double kFound = 1e-12;  // Relative change of what the directions move.
constexpr std::uint64_t kStartSeed = 1;

using Moves = Eigen::SparseMatrix<double, Eigen::RowMajor>;  // A row for each candidate.

Moves movesOf(const std::vector<Largest>& candidates, Eigen::Index shared) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (const auto& [place, by] : candidates[i].gradient)
      entries.emplace_back(static_cast<int>(i), static_cast<int>(place), by);
  }
  Moves moves(static_cast<Eigen::Index>(candidates.size()), shared);
  moves.setFromTriplets(entries.begin(), entries.end());
  return moves;
}

/// The directions among the shared errors that move the candidates most (columns; orthonormal): the first
/// right singular vectors, by subspace iteration (Golub, Van Loan 2013, 8.2.4). Directions that move nearly
/// alike are as good as each other.
Eigen::MatrixXd mainDirections(const Moves& moves) {
  const Eigen::Index rank = std::min(moves.rows(), moves.cols());
  const Eigen::Index sought = std::min(kBlock, rank);
  Eigen::MatrixXd directions(moves.cols(), sought);
  for (Eigen::Index k = 0; k < sought; ++k) {
    const CounterRandom random(kStartSeed, static_cast<std::uint64_t>(k));
    for (Eigen::Index i = 0; i < directions.rows(); ++i)
      directions(i, k) = random.normal(static_cast<std::uint64_t>(i));
  }
  double moved_before = -1.0;
  for (int search = 0; search < kMostSearches; ++search) {
    if (search > 0) directions = (moves.transpose() * (moves * directions)).eval();
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(directions);
    directions = qr.householderQ() * Eigen::MatrixXd::Identity(moves.cols(), sought);
    const Eigen::MatrixXd moved = moves * directions;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> by(moved.transpose() * moved);
    directions = (directions * by.eigenvectors().rowwise().reverse()).eval();
    const double most = by.eigenvalues().tail(std::min(kMain, sought)).sum();
    if (std::abs(most - moved_before) <= kFound * most) break;
    moved_before = most;
  }
  return directions.leftCols(std::min(kMain, sought));
}

/// The largest of those that were added, given where the errors of the main directions are: two at a time.
class Largening {
 public:
  explicit Largening(Eigen::Index shared) : gradient_(Eigen::VectorXd::Zero(shared)) {}

  /// A candidate moved to `mean`, of `variance`, with its gradient in the main directions taken away.
  void add(double mean, double variance, const Moves& moves, Eigen::Index row, const Eigen::Vector2d& main) {
    double with_all = 0.0, own = 0.0;
    for (Moves::InnerIterator entry(moves, row); entry; ++entry) {
      with_all += entry.value() * gradient_[entry.col()];
      own += entry.value() * entry.value();
    }
    const double common = scale_ * with_all - main.dot(main_);
    const double parted = variance_ + variance - 2.0 * common;
    double p = mean_ > mean ? 1.0 : 0.0;
    double density = 0.0;
    const double a = std::sqrt(std::max(parted, 0.0));
    if (!first_ && parted > 0.0) {
      const double z = (mean_ - mean) / a;
      p = normalCdf(z);
      density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
    }
    if (first_) p = 0.0;
    const double square =
        (mean_ * mean_ + variance_) * p + (mean * mean + variance) * (1.0 - p) + (mean_ + mean) * a * density;
    mean_ = mean_ * p + mean * (1.0 - p) + a * density;
    norm2_ = p * p * norm2_ + 2.0 * p * (1.0 - p) * scale_ * with_all + (1.0 - p) * (1.0 - p) * own;
    addGradient(p, moves, row);
    main_ = p * main_ + (1.0 - p) * main;
    variance_ = std::max(square - mean_ * mean_, norm2_ - main_.squaredNorm());
    first_ = false;
  }

  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] double variance() const { return variance_; }
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::MatrixXd& directions) const {
    return scale_ * gradient_ - directions * main_.head(directions.cols());
  }

 private:
  /// The gradient so far is scaled as a whole by a factor of its own: a candidate touches few of its places.
  void addGradient(double p, const Moves& moves, Eigen::Index row) {
    constexpr double kLeast = 1e-100;
    scale_ *= p;
    if (scale_ < kLeast) {
      gradient_ *= scale_;
      scale_ = 1.0;
    }
    for (Moves::InnerIterator entry(moves, row); entry; ++entry)
      gradient_[entry.col()] += (1.0 - p) / scale_ * entry.value();
  }

  bool first_{true};
  double mean_{0.0};
  double variance_{0.0};
  Eigen::VectorXd gradient_;  ///< Main directions included, to be multiplied by scale_.
  double scale_{1.0};
  double norm2_{0.0};  ///< Square of that gradient.
  Eigen::Vector2d main_{Eigen::Vector2d::Zero()};
};

}  // namespace

LargestOfAll largestOfAll(const std::vector<Largest>& candidates, Eigen::Index shared) {
  const Moves moves = movesOf(candidates, shared);
  const Eigen::MatrixXd directions = mainDirections(moves);
  const Eigen::Index n = directions.cols();
  const Eigen::MatrixXd along = moves * directions;
  std::vector<Eigen::Index> order(candidates.size());
  std::vector<double> mean(candidates.size());
  LargestOfAll all{0.0, 0.0, Eigen::VectorXd::Zero(shared)};
  double square = 0.0;
  double weights = 0.0;
  for (int i = -kNodes; i <= kNodes; ++i) {
    for (int k = n < 2 ? 0 : -kNodes; k <= (n < 2 ? 0 : kNodes); ++k) {
      const Eigen::VectorXd at = kNodePitch * Eigen::Vector2d(i, k).head(n);
      for (std::size_t c = 0; c < candidates.size(); ++c)
        mean[c] = candidates[c].mean + along.row(static_cast<Eigen::Index>(c)).dot(at);
      std::iota(order.begin(), order.end(), Eigen::Index{0});
      std::ranges::stable_sort(order, std::greater{},
                               [&](Eigen::Index c) { return mean[static_cast<std::size_t>(c)]; });
      Largening given(shared);
      for (const Eigen::Index c : order) {
        Eigen::Vector2d main = Eigen::Vector2d::Zero();
        main.head(n) = along.row(c).transpose();
        const auto number = static_cast<std::size_t>(c);
        given.add(mean[number], candidates[number].variance - main.squaredNorm(), moves, c, main);
      }
      const double weight = std::exp(-0.5 * at.squaredNorm());
      weights += weight;
      all.mean += weight * given.mean();
      square += weight * (given.mean() * given.mean() + given.variance());
      // The slope along the main directions, by Stein's lemma.
      all.gradient += weight * (given.gradient(directions) + given.mean() * (directions * at));
    }
  }
  all.mean /= weights;
  all.gradient /= weights;
  square /= weights;
  all.variance = std::max(square - all.mean * all.mean, all.gradient.squaredNorm());
  return all;
}

}  // namespace kerfbench::inspect
