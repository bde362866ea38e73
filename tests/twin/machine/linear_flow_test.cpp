// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/linear_flow.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace kerfbench::twin {
namespace {

using Eigen::MatrixXd;

TEST(MatrixExponential, TurnsARotationIntoSineAndCosine) {
  for (const double angle : {1e-9, 0.3, 1.0, 7.0, 40.0}) {
    MatrixXd spin(2, 2);
    spin << 0.0, -angle, angle, 0.0;
    MatrixXd expected(2, 2);
    expected << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    EXPECT_LT((matrixExponential(spin) - expected).cwiseAbs().maxCoeff(), 1e-13 * (1.0 + angle));
  }
}

TEST(MatrixExponential, KeepsItsDigitsBetweenEntriesOfTwelveOrders) {
  // The oscillator is in its own units: position and velocity differ by w = 1e6.
  const double w = 1e6;
  const double h = 1e-6;
  MatrixXd matrix(2, 2);
  matrix << 0.0, h, -w * w * h, 0.0;
  const MatrixXd flow = matrixExponential(matrix);
  EXPECT_NEAR(flow(0, 0) / std::cos(w * h), 1.0, 1e-15);
  EXPECT_NEAR(flow(0, 1) / (std::sin(w * h) / w), 1.0, 1e-15);
  EXPECT_NEAR(flow(1, 0) / (-w * std::sin(w * h)), 1.0, 1e-15);
}

TEST(MatrixExponential, OfANilpotentMatrixIsAPolynomial) {
  MatrixXd shift = MatrixXd::Zero(4, 4);
  for (int i = 0; i < 3; ++i) shift(i, i + 1) = 2.0;
  const MatrixXd flow = matrixExponential(shift);
  EXPECT_DOUBLE_EQ(flow(0, 1), 2.0);
  EXPECT_DOUBLE_EQ(flow(0, 2), 2.0);
  EXPECT_DOUBLE_EQ(flow(0, 3), 8.0 / 6.0);
  EXPECT_EQ(flow(3, 0), 0.0);
}

TEST(MatrixExponential, ForthAndBackIsNothing) {
  MatrixXd matrix = MatrixXd::Zero(6, 6);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) matrix(i, j) = std::sin(3.0 * i + 7.0 * j + 1.0);
  }
  const MatrixXd both = matrixExponential(matrix) * matrixExponential(-matrix);
  EXPECT_LT((both - MatrixXd::Identity(6, 6)).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(MatrixExponential, RefusesWhatIsNotFinite) {
  EXPECT_THROW((void)matrixExponential(MatrixXd::Constant(2, 2, std::nan(""))), std::invalid_argument);
}

TEST(LinearFlow, FollowsConstantAndLinearInputsExactly) {
  // The equation x' = -r x + r u is a first-order lag.
  const double r = 5e4;
  const double h = 1e-5;
  const LinearFlow flow(MatrixXd::Constant(1, 1, -r), MatrixXd::Constant(1, 1, r), h);
  const double values[] = {0.3, 1.0};
  double next[LinearFlow::kMostRows];
  flow.advance(values, next);
  EXPECT_NEAR(next[0], 1.0 + (0.3 - 1.0) * std::exp(-r * h), 1e-15);
  flow.addRamp(0, 0.5, next);
  // A ramp drives the lag, which trails it by 1/r once it has settled.
  const double slope = 0.5 / h;
  const double ramped = 0.5 - slope / r * (1.0 - std::exp(-r * h));
  EXPECT_NEAR(next[0], 1.0 + (0.3 - 1.0) * std::exp(-r * h) + ramped, 1e-15);
}

TEST(LinearFlow, FollowsAParabolaExactly) {
  // The equation x'' = w is integrated twice, with w = 3 s - 5 s².
  MatrixXd A = MatrixXd::Zero(2, 2);
  A(0, 1) = 1.0;
  MatrixXd B = MatrixXd::Zero(2, 1);
  B(1, 0) = 1.0;
  const double h = 1e-5;
  const LinearFlow flow(A, B, h);
  const double rest[] = {0.0, 0.0, 0.0};
  double next[LinearFlow::kMostRows];
  flow.advance(rest, next);
  flow.addRamp(0, 3.0, next);
  flow.addBend(0, -5.0, next);
  EXPECT_NEAR(next[0] / (h * h), 3.0 / 6.0 - 5.0 / 12.0, 1e-15);
  EXPECT_NEAR(next[1] / h, 3.0 / 2.0 - 5.0 / 3.0, 1e-15);
}

TEST(LinearFlow, TwoHalfStepsAreOneStep) {
  MatrixXd A(3, 3);
  A << 0.0, 1.0, 0.0, -4e8, -3e3, 2e4, 0.0, 0.0, -6e4;
  MatrixXd B(3, 2);
  B << 0.0, 0.0, 4e8, 1.0, 0.0, 6e4;
  const LinearFlow whole(A, B, 1e-5);
  const LinearFlow half(A, B, 5e-6);
  double state[] = {0.1, -300.0, 2.0, 0.7, -0.3};
  double once[LinearFlow::kMostRows];
  double twice[LinearFlow::kMostRows];
  whole.advance(state, once);
  half.advance(state, twice);
  for (int i = 0; i < 3; ++i) state[i] = twice[i];
  half.advance(state, twice);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(twice[i] / once[i], 1.0, 1e-13) << i;
}

}  // namespace
}  // namespace kerfbench::twin
