// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/deviation/largest_of_all.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <Eigen/SVD>

#include "twin/base/random.h"

namespace kerfbench::inspect {
namespace {

/// The same method with all gradients at full length: slow, and simple.
class Dense {
 public:
  Dense(const std::vector<Largest>& candidates, Eigen::Index shared)
      : candidates_(candidates),
        rows_(Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(candidates.size()), shared)) {
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      for (const auto& [place, by] : candidates[c].gradient) rows_(static_cast<Eigen::Index>(c), place) = by;
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows_, Eigen::ComputeThinV);
    directions_ = svd.matrixV().leftCols(2);
  }

  [[nodiscard]] LargestOfAll estimate() const {
    LargestOfAll all{0.0, 0.0, Eigen::VectorXd::Zero(rows_.cols())};
    double square = 0.0, weights = 0.0;
    for (int i = -7; i <= 7; ++i) {
      for (int k = -7; k <= 7; ++k) {
        const Eigen::Vector2d at(0.5 * i, 0.5 * k);
        const double weight = std::exp(-0.5 * at.squaredNorm());
        const LargestOfAll given = givenMain(at);
        weights += weight;
        all.mean += weight * given.mean;
        square += weight * (given.mean * given.mean + given.variance);
        all.gradient += weight * (given.gradient + given.mean * (directions_ * at));
      }
    }
    all.mean /= weights;
    all.gradient /= weights;
    all.variance = square / weights - all.mean * all.mean;
    return all;
  }

 private:
  [[nodiscard]] LargestOfAll givenMain(const Eigen::Vector2d& at) const {
    std::vector<LargestOfAll> moved;
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      const Eigen::VectorXd row = rows_.row(static_cast<Eigen::Index>(c)).transpose();
      const Eigen::Vector2d along = directions_.transpose() * row;
      moved.push_back({candidates_[c].mean + along.dot(at), candidates_[c].variance - along.squaredNorm(),
                       row - directions_ * along});
    }
    std::ranges::stable_sort(moved, std::greater{}, &LargestOfAll::mean);
    LargestOfAll all = moved.front();
    for (std::size_t c = 1; c < moved.size(); ++c) all = largerOf(all, moved[c]);
    return all;
  }
  /// Clark (1961).
  static LargestOfAll largerOf(const LargestOfAll& x, const LargestOfAll& y) {
    const double a = std::sqrt(x.variance + y.variance - 2.0 * x.gradient.dot(y.gradient));
    const double z = (x.mean - y.mean) / a;
    const double p = 0.5 * std::erfc(-z / std::numbers::sqrt2);
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
    LargestOfAll out;
    out.mean = x.mean * p + y.mean * (1.0 - p) + a * density;
    const double square = (x.mean * x.mean + x.variance) * p + (y.mean * y.mean + y.variance) * (1.0 - p) +
                          (x.mean + y.mean) * a * density;
    out.gradient = p * x.gradient + (1.0 - p) * y.gradient;
    out.variance = std::max(square - out.mean * out.mean, out.gradient.squaredNorm());
    return out;
  }

  const std::vector<Largest>& candidates_;
  Eigen::MatrixXd rows_;
  Eigen::MatrixXd directions_;
};

// The integral goes to three and a half standard deviations: a part in a thousand of what moves is beyond.
TEST(LargestOfAll, OfOneIsThatOne) {
  const LargestOfAll all = largestOfAll({{0.3, 0.0025, {{1, 0.03}, {4, -0.02}}}}, 6);
  EXPECT_NEAR(all.mean, 0.3, 1e-12);
  EXPECT_NEAR(all.variance, 0.0025, 5e-6);
  Eigen::VectorXd gradient(6);
  gradient << 0.0, 0.03, 0.0, 0.0, -0.02, 0.0;
  EXPECT_LT((all.gradient - gradient).norm(), 1e-4);
}

TEST(LargestOfAll, OfTwoThatNoErrorMovesIsClarks) {
  const LargestOfAll all = largestOfAll({{0.0, 1.0, {}}, {0.0, 1.0, {}}}, 3);
  EXPECT_NEAR(all.mean, 1.0 / std::sqrt(std::numbers::pi), 1e-9);
  EXPECT_NEAR(all.variance, 1.0 - 1.0 / std::numbers::pi, 1e-9);
}

/// The error that makes one larger makes the other smaller: the larger is the mean and what half of a normal
/// error is on average.
TEST(LargestOfAll, AnErrorThatPartsTwoSidesIsNoSlope) {
  const LargestOfAll all = largestOfAll({{0.1, 0.0100001, {{0, 0.1}}}, {0.1, 0.0100001, {{0, -0.1}}}}, 1);
  EXPECT_NEAR(all.mean, 0.1 + 0.1 * std::sqrt(2.0 / std::numbers::pi), 2e-3);
  EXPECT_NEAR(all.gradient[0], 0.0, 1e-12);
}

/// Units of eight lines: each unit has errors of its own, each tile too, and the camera moves all.
TEST(LargestOfAll, OfManyIsWhatGradientsOfFullLengthGive) {
  std::vector<Largest> candidates;
  constexpr Eigen::Index kUnits = 12;
  const CounterRandom random(5, 0);
  std::uint64_t next = 0;
  for (Eigen::Index unit = 0; unit < kUnits; ++unit) {
    for (int line = 0; line < 8; ++line) {
      const double sign = line % 2 == 0 ? 1.0 : -1.0;
      candidates.push_back({0.01 + 0.002 * random.uniform(next),
                            1.2e-5,
                            {{unit, 1.5e-3 * sign},
                             {kUnits + unit / 2, 1e-3},
                             {2 * kUnits, 1.2e-3 * sign},
                             {2 * kUnits + 1, 0.8e-3}}});
      ++next;
    }
  }
  constexpr Eigen::Index kShared = 2 * kUnits + 2;
  const LargestOfAll all = largestOfAll(candidates, kShared);
  const LargestOfAll dense = Dense(candidates, kShared).estimate();
  EXPECT_NEAR(all.mean, dense.mean, 1e-9 * dense.mean);
  EXPECT_NEAR(all.variance, dense.variance, 1e-6 * dense.variance);
  EXPECT_LT((all.gradient - dense.gradient).norm(), 1e-6 * dense.gradient.norm());
}

/// What is added for a candidate touches its own places only, and what others have must not leak into it.
TEST(LargestOfAll, OneFarAboveTheOthersStandsAlone) {
  std::vector<Largest> candidates{{1.0, 1e-4, {{0, 6e-3}}}};
  for (Eigen::Index i = 1; i < 50; ++i) candidates.push_back({0.01, 1e-4, {{i, 5e-3}}});
  const LargestOfAll all = largestOfAll(candidates, 50);
  EXPECT_NEAR(all.mean, 1.0, 1e-9);
  EXPECT_NEAR(all.gradient[0], 6e-3, 2e-5);
  EXPECT_LT(all.gradient.tail(49).norm(), 1e-6);
}

}  // namespace
}  // namespace kerfbench::inspect
