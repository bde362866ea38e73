// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/linear_flow.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kerfbench::twin {
namespace {

// Binary exponents of a scaling that makes rows and columns equally large (Osborne 1960). Powers of two cause
// no rounding.
std::vector<int> balancing(const Eigen::MatrixXd& matrix) {
  const auto n = static_cast<std::size_t>(matrix.rows());
  std::vector<int> exponent(n, 0);
  constexpr int kSweeps = 20;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t i = 0; i < n; ++i) {
      double row = 0.0;
      double column = 0.0;
      for (std::size_t j = 0; j < n; ++j) {
        if (i == j) continue;
        const auto a = static_cast<Eigen::Index>(i);
        const auto b = static_cast<Eigen::Index>(j);
        row += std::ldexp(std::abs(matrix(a, b)), exponent[j] - exponent[i]);
        column += std::ldexp(std::abs(matrix(b, a)), exponent[i] - exponent[j]);
      }
      if (row == 0 || column == 0) continue;
      int row_exponent = 0;
      int column_exponent = 0;
      (void)std::frexp(row, &row_exponent);
      (void)std::frexp(column, &column_exponent);
      exponent[i] += (row_exponent - column_exponent) / 2;
    }
  }
  return exponent;
}

}  // namespace

Eigen::MatrixXd matrixExponential(const Eigen::MatrixXd& matrix) {
  const Eigen::Index n = matrix.rows();
  const std::vector<int> scale = balancing(matrix);
  const auto exponent = [&](Eigen::Index i, Eigen::Index j) {
    return scale[static_cast<std::size_t>(j)] - scale[static_cast<std::size_t>(i)];
  };
  Eigen::MatrixXd small(n, n);
  double norm = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    double row = 0.0;
    for (Eigen::Index j = 0; j < n; ++j) {
      small(i, j) = std::ldexp(matrix(i, j), exponent(i, j));
      row += std::abs(small(i, j));
    }
    if (!std::isfinite(row)) throw std::invalid_argument("matrixExponential: not finite");
    norm = std::max(norm, row);
  }
  int halvings = 0;
  (void)std::frexp(norm, &halvings);
  halvings = std::max(0, halvings + 1);  // The norm is then below a half.
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) small(i, j) = std::ldexp(small(i, j), -halvings);
  }
  // Squaring e^x - 1 in place of e^x keeps the small entries' digits: (1 + s)² - 1 = 2 s + s².
  constexpr int kTerms = 16;  // Error bound: 0.5^17 / 17! < 1e-19.
  Eigen::MatrixXd term = small;
  Eigen::MatrixXd less_one = small;
  for (int k = 2; k <= kTerms; ++k) {
    term = (term.lazyProduct(small) / static_cast<double>(k)).eval();
    less_one += term;
  }
  for (int k = 0; k < halvings; ++k) {
    less_one = (2.0 * less_one + less_one.lazyProduct(less_one)).eval();
  }
  for (Eigen::Index i = 0; i < n; ++i) less_one(i, i) += 1.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) less_one(i, j) = std::ldexp(less_one(i, j), -exponent(i, j));
  }
  return less_one;
}

LinearFlow::LinearFlow(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double step_s)
    : states_(static_cast<std::size_t>(A.rows())),
      padded_((states_ + kRows - 1) / kRows * kRows),
      columns_(states_ + static_cast<std::size_t>(B.cols())),
      step_(padded_ * columns_, 0.0),
      ramp_(padded_ * static_cast<std::size_t>(B.cols()), 0.0),
      bend_(ramp_) {
  if (padded_ > kMostRows) throw std::invalid_argument("LinearFlow: too many states");
  const Eigen::Index n = A.rows();
  const Eigen::Index inputs = B.cols();
  // The inputs are states over s: dw/ds = r, dr/ds = p, dp/ds = 0, where s² has p = 2.
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(n + 3 * inputs, n + 3 * inputs);
  all.topLeftCorner(n, n) = step_s * A;
  all.block(0, n, n, inputs) = step_s * B;
  all.block(n, n + inputs, 2 * inputs, 2 * inputs).setIdentity();
  const Eigen::MatrixXd flow = matrixExponential(all);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = static_cast<std::size_t>(i);
    for (Eigen::Index j = 0; j < n + inputs; ++j) {
      step_[static_cast<std::size_t>(j) * padded_ + row] = flow(i, j);
    }
    for (Eigen::Index j = 0; j < inputs; ++j) {
      const std::size_t place = static_cast<std::size_t>(j) * padded_ + row;
      ramp_[place] = flow(i, n + inputs + j);
      bend_[place] = 2.0 * flow(i, n + 2 * inputs + j);
    }
  }
}

void LinearFlow::advance(const double* state_and_inputs, double* next) const {
  // Each row is summed in the order of the columns, however many rows go at once.
  using Rows = Eigen::Array<double, kRows, 1>;
  for (std::size_t first = 0; first < padded_; first += kRows) {
    const double* column = step_.data() + first;
    Rows sum = Rows::Zero();
    for (std::size_t j = 0; j < columns_; ++j, column += padded_) {
      sum += Eigen::Map<const Rows>(column) * state_and_inputs[j];
    }
    Eigen::Map<Rows>(next + first) = sum;
  }
}

void LinearFlow::add(const std::vector<double>& columns, std::size_t input, double value,
                     double* next) const {
  const double* column = columns.data() + input * padded_;
  for (std::size_t i = 0; i < states_; ++i) next[i] += column[i] * value;
}

}  // namespace kerfbench::twin
