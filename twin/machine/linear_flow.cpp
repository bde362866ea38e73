// SPDX-License-Identifier: Apache-2.0
#include "twin/machine/linear_flow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace kerfbench::twin {
namespace {

/// Sums of neighbouring rows, in registers.
using Rows = double __attribute__((vector_size(LinearFlow::kRows * sizeof(double))));

// Scaling that makes rows and columns equally large (Osborne 1960): D⁻¹ M D with this diagonal D. Powers of
// two cause no rounding.
Eigen::ArrayXd balancing(const Eigen::MatrixXd& matrix) {
  const Eigen::Index n = matrix.rows();
  const Eigen::MatrixXd sizes = matrix.cwiseAbs();
  Eigen::ArrayXd scale = Eigen::ArrayXd::Ones(n);
  constexpr int kSweeps = 20;
  bool changed = true;
  for (int sweep = 0; sweep < kSweeps && changed; ++sweep) {
    changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      double row = 0.0;
      double column = 0.0;
      for (Eigen::Index j = 0; j < n; ++j) {
        if (i == j) continue;
        row += sizes(i, j) * (scale[j] / scale[i]);
        column += sizes(j, i) * (scale[i] / scale[j]);
      }
      if (row == 0 || column == 0) continue;
      int row_exponent = 0;
      int column_exponent = 0;
      (void)std::frexp(row, &row_exponent);
      (void)std::frexp(column, &column_exponent);
      const int by = (row_exponent - column_exponent) / 2;
      scale[i] = std::ldexp(scale[i], by);
      changed = changed || by != 0;
    }
  }
  return scale;
}

// Product that passes over the zeros of b: nine tenths of a mechanism's matrix.
Eigen::MatrixXd sparseProduct(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(a.rows(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    for (Eigen::Index k = 0; k < b.rows(); ++k) {
      if (b(k, j) != 0.0) product.col(j) += a.col(k) * b(k, j);
    }
  }
  return product;
}

}  // namespace

Eigen::MatrixXd matrixExponential(const Eigen::MatrixXd& matrix) {
  const Eigen::Index n = matrix.rows();
  const Eigen::ArrayXd scale = balancing(matrix);
  const auto factor = [&scale](Eigen::Index i, Eigen::Index j) { return scale[j] / scale[i]; };
  Eigen::MatrixXd small(n, n);
  double norm = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    double row = 0.0;
    for (Eigen::Index j = 0; j < n; ++j) {
      small(i, j) = matrix(i, j) * factor(i, j);
      row += std::abs(small(i, j));
    }
    if (!std::isfinite(row)) throw std::invalid_argument("matrixExponential: not finite");
    norm = std::max(norm, row);
  }
  int halvings = 0;
  (void)std::frexp(norm, &halvings);
  halvings = std::max(0, halvings + 1);  // The norm is then below a half.
  small *= std::ldexp(1.0, -halvings);
  // Squaring e^x - 1 in place of e^x keeps the small entries' digits: (1 + s)² - 1 = 2 s + s².
  constexpr int kTerms = 16;  // Error bound: 0.5^17 / 17! < 1e-19.
  Eigen::MatrixXd term = small;
  Eigen::MatrixXd less_one = small;
  for (int k = 2; k <= kTerms; ++k) {
    term = sparseProduct(term, small) / static_cast<double>(k);
    less_one += term;
  }
  for (int k = 0; k < halvings; ++k) less_one = 2.0 * less_one + sparseProduct(less_one, less_one);
  for (Eigen::Index i = 0; i < n; ++i) less_one(i, i) += 1.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) less_one(i, j) *= factor(j, i);
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

template <std::size_t kBlocks>
void LinearFlow::advanceRows(std::size_t first, const double* state_and_inputs, double* next) const {
  // Eigen would keep a sum of more than one packet in memory.
  std::array<Rows, kBlocks> sums{};
  const double* column = step_.data() + first;
  for (std::size_t j = 0; j < columns_; ++j, column += padded_) {
    for (std::size_t b = 0; b < kBlocks; ++b) {
      Rows rows;
      std::memcpy(&rows, column + b * kRows, sizeof rows);
      sums[b] += rows * state_and_inputs[j];
    }
  }
  std::memcpy(next + first, sums.data(), sizeof sums);
}

void LinearFlow::advance(const double* state_and_inputs, double* next) const {
  // Each row is summed in the order of the columns, however many rows go at once. A mirror has four states, a
  // gantry or a belt up to twelve: their sums stay in registers.
  switch (padded_) {
    case kRows:
      return advanceRows<1>(0, state_and_inputs, next);
    case 2 * kRows:
      return advanceRows<2>(0, state_and_inputs, next);
    case 3 * kRows:
      return advanceRows<3>(0, state_and_inputs, next);
    default:
      for (std::size_t first = 0; first < padded_; first += kRows) {
        advanceRows<1>(first, state_and_inputs, next);
      }
  }
}

void LinearFlow::add(const std::vector<double>& columns, std::size_t input, double value,
                     double* next) const {
  const double* column = columns.data() + input * padded_;
  for (std::size_t i = 0; i < states_; ++i) next[i] += column[i] * value;
}

}  // namespace kerfbench::twin
