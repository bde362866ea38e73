// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/head/joint_solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include <Eigen/LU>

#include "twin/base/random.h"

namespace kerfbench::calibrate {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Eigen::Index kCount = static_cast<Eigen::Index>(kHeadParameterCount);

/// Marks of three sheets, the last of which shares nothing, with all their unknowns written out: scaled
/// departures, coefficients, shared errors.
class ThreeSheets : public testing::Test {
 protected:
  static constexpr Eigen::Index kMarks = 30, kShared = 6;

  ThreeSheets() : values_(kMarks, basis_.size()), shared_(MatrixXd::Zero(2 * kMarks, kShared)) {
    const CounterRandom random(7, 1);
    std::uint64_t next = 0;
    const auto draw = [&](Eigen::Index, Eigen::Index) { return random.normal(next++); };
    rows_ = WhitenedRows::NullaryExpr(2 * kMarks, kCount + 1, draw);
    written_out_ = MatrixXd::Zero(2 * kMarks, unknowns());
    written_out_.leftCols<kCount>() = rows_.leftCols<kCount>();
    for (Eigen::Index i = 0; i < kMarks; ++i) {
      whitenings_.emplace_back(Eigen::Matrix2d::NullaryExpr(draw));
      const double x_mm = 90.0 * random.uniform(next++);
      const double y_mm = 40.0 * random.uniform(next++);
      values_.row(i) = basis_.at({x_mm, y_mm}).at.transpose();
      written_out_.block(2 * i, kCount, 2, basis_.size()) = whitenings_.back().col(0) * values_.row(i);
      written_out_.block(2 * i, kCount + basis_.size(), 2, basis_.size()) =
          whitenings_.back().col(1) * values_.row(i);
      if (i < 20) shared_.block<2, 3>(2 * i, i < 8 ? 0 : 3) = Eigen::Matrix<double, 2, 3>::NullaryExpr(draw);
    }
    written_out_.rightCols<kShared>() = shared_;
  }

  [[nodiscard]] Eigen::Index unknowns() const { return kCount + 2 * basis_.size() + kShared; }

  /// Solves for all unknowns by the inverse of the whole normal matrix.
  void solveWrittenOut() {
    VectorXd weights = VectorXd::Ones(unknowns());
    for (Eigen::Index k = 0; k < basis_.size(); ++k) {
      const double sigma_mm = prior_.amplitude_mm * std::pow(prior_.decay, basis_.order(k).sum());
      weights[kCount + k] = weights[kCount + basis_.size() + k] = 1.0 / (sigma_mm * sigma_mm);
    }
    MatrixXd normal = written_out_.transpose() * written_out_;
    normal.diagonal() += weights;
    covariance_ = normal.inverse();
    VectorXd gradient = written_out_.transpose() * rows_.col(kCount);
    gradient.head<kCount>() += home_;
    mean_ = covariance_ * gradient;
    least_ = rows_.col(kCount).squaredNorm() + home_.squaredNorm() - gradient.dot(mean_);
  }

  SmoothBasis basis_{Eigen::AlignedBox2d(Eigen::Vector2d(0, 0), Eigen::Vector2d(90, 40)), 2};
  SurfacePrior prior_{0.3, 0.7, 0.0};
  WhitenedRows rows_;
  HeadVector home_ = HeadVector::LinSpaced(-0.7, 0.4);
  RowMatrix values_;
  std::vector<Eigen::Matrix2d> whitenings_;
  MatrixXd shared_, written_out_, covariance_;
  VectorXd mean_;
  double least_{};
};

TEST_F(ThreeSheets, WhatTheyShareIntegratedOutIsWhatItIsWrittenOut) {
  JointMarks marks(whitenings_, values_, shared_);
  marks.linearise(rows_, home_);
  const JointSolution joint = JointSolver(marks, sigmasOf(prior_, basis_)).solve();
  solveWrittenOut();
  const Eigen::Index x = joint.unknowns.size();
  ASSERT_EQ(x + kShared, unknowns());
  EXPECT_LT((joint.unknowns - mean_.head(x)).norm(), 1e-9 * mean_.norm());
  const MatrixXd covariance = joint.covariance_root * joint.covariance_root.transpose();
  EXPECT_LT((covariance - covariance_.topLeftCorner(x, x)).norm(), 1e-9 * covariance.norm());
  EXPECT_LT((marks.surfaceDiagonal() - marks.surfaceSquare().diagonal()).norm(),
            1e-9 * marks.surfaceDiagonal().norm());
}

TEST_F(ThreeSheets, TellsWhatTheyShare) {
  JointMarks marks(whitenings_, values_, shared_);
  marks.linearise(rows_, home_);
  const JointSolution joint = JointSolver(marks, sigmasOf(prior_, basis_)).solve();
  solveWrittenOut();
  const Eigen::Index x = joint.unknowns.size();
  const MatrixXd slopes = marks.sharedSlopes(), reach = marks.sharedReach(shared_);
  const MatrixXd fixed = written_out_.leftCols(x).transpose() - slopes.leftCols(x).transpose() * reach;
  const VectorXd predicted = fixed.transpose() * joint.unknowns + reach.transpose() * slopes.rightCols<1>();
  EXPECT_LT((predicted - written_out_ * mean_).norm(), 1e-9 * predicted.norm());
  const MatrixXd moved = joint.covariance_root.transpose() * fixed;
  const MatrixXd covariance = moved.transpose() * moved + reach.transpose() * reach;
  EXPECT_LT((covariance - written_out_ * covariance_ * written_out_.transpose()).norm(),
            1e-9 * covariance.norm());
}

TEST_F(ThreeSheets, TellsWhatAStepLeavesWhenAllElseFitsBest) {
  JointMarks marks(whitenings_, values_, shared_);
  marks.linearise(rows_, home_);
  const ModelInformation model = JointSolver(marks, sigmasOf(prior_, basis_)).model();
  solveWrittenOut();
  const HeadVector best = mean_.head<kCount>(), off = HeadVector::LinSpaced(-1.0, 2.0);
  const MatrixXd precision = covariance_.topLeftCorner<kCount, kCount>().inverse();
  EXPECT_NEAR(model.misfit(best), least_, 1e-9 * least_);
  EXPECT_NEAR(model.misfit(best + off), least_ + off.dot(precision * off), 1e-9 * model.misfit(best + off));

  constexpr double kDamping = 3.0;
  EXPECT_LT((model.step() - best).norm(), 1e-9 * best.norm());
  const MatrixXd damped = precision + kDamping * MatrixXd::Identity(kCount, kCount);
  EXPECT_LT((model.step(kDamping) - damped.inverse() * precision * best).norm(), 1e-9 * best.norm());
}

TEST_F(ThreeSheets, TheFactorOfAllTolerancesIsThatOfTheDepartures) {
  JointMarks marks(whitenings_, values_, shared_);
  const auto factorAt = [&](const HeadVector& step) {
    WhitenedRows there = rows_;
    there.col(kCount) -= rows_.leftCols<kCount>() * step;
    marks.linearise(there, home_ - step);
    return toleranceFactor(JointSolver(marks, sigmasOf(prior_, basis_)).model());
  };
  // The factor is the same at any point of linearisation.
  EXPECT_NEAR(factorAt(HeadVector::LinSpaced(0.3, -2.0)), factorAt(HeadVector::Zero()), 1e-9);
}

}  // namespace
}  // namespace kerfbench::calibrate
