// SPDX-License-Identifier: Apache-2.0
#include "hil/base/least_squares.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "twin/base/random.h"

namespace kerfbench::base {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr LeastSquaresOptions kTight{.most_iterations = 200,
                                     .start_radius = 1e4,
                                     .function_tolerance = 1e-15,
                                     .gradient_tolerance = 1e-12,
                                     .parameter_tolerance = 1e-14};

/// Rosenbrock's valley: smallest at (1, 1), where it is zero.
LeastSquaresProblem rosenbrock() {
  LeastSquaresProblem problem;
  problem.parameters = problem.residuals = 2;
  problem.evaluate = [](const VectorXd& x, VectorXd& r, MatrixXd* j) {
    r << 10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0];
    if (j != nullptr) *j << -20.0 * x[0], 10.0, -1.0, 0.0;
    return true;
  };
  return problem;
}

/// A line through points; every tenth is far off if `spoilt`.
struct Line {
  static constexpr Index kPoints = 60;
  VectorXd at{VectorXd::LinSpaced(kPoints, -1.0, 1.0)}, y{kPoints};

  explicit Line(bool spoilt) {
    const CounterRandom random(7, 1);
    for (Index i = 0; i < kPoints; ++i) {
      y[i] = 2.0 - 3.0 * at[i] + 0.01 * random.normal(static_cast<std::uint64_t>(i));
      if (spoilt && i % 10 == 3) y[i] += 40.0;
    }
  }
  [[nodiscard]] LeastSquaresProblem problem(double loss_scale) const {
    LeastSquaresProblem problem;
    problem.parameters = 2;
    problem.residuals = kPoints;
    problem.robust_blocks = loss_scale > 0.0 ? kPoints : 0;
    problem.loss_scale = loss_scale;
    problem.evaluate = [this](const VectorXd& x, VectorXd& r, MatrixXd* j) {
      r = (y.array() - x[0] - x[1] * at.array()) / 0.01;
      if (j != nullptr) *j << VectorXd::Constant(kPoints, -100.0), -100.0 * at;
      return true;
    };
    return problem;
  }
};

TEST(LeastSquares, FindsTheEndOfRosenbrocksValley) {
  const LeastSquaresSummary summary = minimise(rosenbrock(), Eigen::Vector2d(-1.2, 1.0), kTight);
  EXPECT_TRUE(summary.settled());
  EXPECT_LT((summary.x - Eigen::Vector2d(1.0, 1.0)).norm(), 1e-10);
  EXPECT_NEAR(summary.first_cost, 12.1, 1e-12);  // Cost by hand: (4.4² + 2.2²) / 2.
  EXPECT_LE(summary.accepted, summary.iterations);
}

TEST(LeastSquares, AgreesWithTheNormalEquationsOnALinearProblem) {
  const Line line(false);
  MatrixXd design(Line::kPoints, 2);
  design << VectorXd::Ones(Line::kPoints), line.at;
  const VectorXd expected = (design.transpose() * design).ldlt().solve(design.transpose() * line.y);
  const LeastSquaresSummary summary = minimise(line.problem(0.0), Eigen::Vector2d(50.0, -80.0), kTight);
  EXPECT_TRUE(summary.settled());
  EXPECT_LT((summary.x - expected).norm(), 1e-9);
}

TEST(LeastSquares, FalseMeasurementsPullWithoutALossAndHardlyWithOne) {
  const Line line(true);
  const Eigen::Vector2d truth(2.0, -3.0);
  EXPECT_GT((minimise(line.problem(0.0), Eigen::Vector2d::Zero(), kTight).x - truth).norm(), 1.0);
  const LeastSquaresSummary robust = minimise(line.problem(2.0), Eigen::Vector2d::Zero(), kTight);
  EXPECT_TRUE(robust.settled());
  EXPECT_LT((robust.x - truth).norm(), 0.01);
}

TEST(LeastSquares, ALossOfAWideScaleIsNone) {
  const Line line(false);
  const VectorXd plain = minimise(line.problem(0.0), Eigen::Vector2d(1.0, 1.0), kTight).x;
  const VectorXd wide = minimise(line.problem(1e3), Eigen::Vector2d(1.0, 1.0), kTight).x;
  EXPECT_LT((plain - wide).norm(), 1e-7);
}

// Where the sum of losses is smallest, its slope by differences of the cost is zero.
TEST(LeastSquares, EndsWhereTheRobustCostIsFlat) {
  const Line line(true);
  const LeastSquaresProblem problem = line.problem(3.0);
  const LeastSquaresSummary best = minimise(problem, Eigen::Vector2d::Zero(), kTight);
  LeastSquaresOptions none;
  none.most_iterations = 0;
  for (Index k = 0; k < 2; ++k) {
    const VectorXd step = 1e-4 * Eigen::Vector2d::Unit(k);
    const double up = minimise(problem, best.x + step, none).first_cost;
    const double down = minimise(problem, best.x - step, none).first_cost;
    EXPECT_GT(up, best.cost);
    EXPECT_GT(down, best.cost);
    EXPECT_LT(std::abs(up - down), 1e-3 * (up + down - 2.0 * best.cost));
  }
}

TEST(LeastSquares, GoesAroundPlacesWhereTheModelHasNoValue) {
  LeastSquaresProblem problem;
  problem.parameters = problem.residuals = 1;
  // The first undamped step from 3 leads to below zero.
  problem.evaluate = [](const VectorXd& x, VectorXd& r, MatrixXd* j) {
    if (!(x[0] > 0.0)) return false;
    r[0] = std::log(x[0]) + 2.0;
    if (j != nullptr) (*j)(0, 0) = 1.0 / x[0];
    return true;
  };
  const LeastSquaresSummary summary = minimise(problem, VectorXd::Constant(1, 3.0), kTight);
  EXPECT_TRUE(summary.settled());
  EXPECT_NEAR(summary.x[0], std::exp(-2.0), 1e-10);
  EXPECT_LT(summary.accepted, summary.iterations);
  const LeastSquaresSummary nowhere = minimise(problem, VectorXd::Constant(1, -1.0), kTight);
  EXPECT_EQ(nowhere.end, LeastSquaresEnd::kFailed);
  EXPECT_EQ(nowhere.x[0], -1.0);
}

TEST(LeastSquares, SaysThatItsIterationsAreUsedUp) {
  LeastSquaresOptions few = kTight;
  few.most_iterations = 3;
  const LeastSquaresSummary summary = minimise(rosenbrock(), Eigen::Vector2d(-1.2, 1.0), few);
  EXPECT_EQ(summary.end, LeastSquaresEnd::kLimit);
  EXPECT_EQ(summary.iterations, 3);
  EXPECT_LE(summary.cost, summary.first_cost);
}

TEST(LeastSquares, RefusesNumbersOutOfRange) {
  const Eigen::Vector2d start(0.0, 0.0);
  LeastSquaresProblem problem = rosenbrock();
  EXPECT_THROW((void)minimise(problem, VectorXd::Zero(3)), std::invalid_argument);
  problem.robust_blocks = 1;
  EXPECT_THROW((void)minimise(problem, start), std::invalid_argument);
  problem.loss_scale = 1.0;
  EXPECT_NO_THROW((void)minimise(problem, start));
  problem.robust_blocks = 3;
  EXPECT_THROW((void)minimise(problem, start), std::invalid_argument);
  problem.evaluate = nullptr;
  EXPECT_THROW((void)minimise(problem, start), std::invalid_argument);
}

}  // namespace
}  // namespace kerfbench::base
