// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace kerfbench::twin {

/// exp(matrix), by Taylor series after balancing, scaling and before squaring. Good to rounding for the
/// matrices of a step, whose entries differ by many orders of magnitude but whose eigenvalues are of order 1.
Eigen::MatrixXd matrixExponential(const Eigen::MatrixXd& matrix);

/// Exact flow over one step of
///
///     dx/dt = A x + B w(t)
///
/// with inputs w that are polynomials of the time share s = t/h up to the second order: for
/// w = w0 + r s + c s² it is x(h) = E x(0) + V w0 + R r + C c.
class LinearFlow {
 public:
  LinearFlow(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, double step_s);

  [[nodiscard]] std::size_t states() const { return states_; }
  /// Computes x(h) for constant inputs into `next`. `state_and_inputs`: x, then w(0). `next` has room for
  /// states() rounded up to a multiple of kRows and must not overlap.
  void advance(const double* state_and_inputs, double* next) const;
  /// Adds to `next` the effect of r of input i.
  void addRamp(std::size_t input, double ramp, double* next) const { add(ramp_, input, ramp, next); }
  void addBend(std::size_t input, double bend, double* next) const { add(bend_, input, bend, next); }

  static constexpr std::size_t kRows = 4;  ///< Rows are padded to a multiple of this.
  static constexpr std::size_t kMostRows = 32;

 private:
  /// Rows [first, first + kBlocks * kRows) of advance().
  template <std::size_t kBlocks>
  void advanceRows(std::size_t first, const double* state_and_inputs, double* next) const;
  void add(const std::vector<double>& columns, std::size_t input, double value, double* next) const;

  std::size_t states_, padded_, columns_;
  std::vector<double> step_;         ///< Columns of E and V, padded.
  std::vector<double> ramp_, bend_;  ///< Columns of R and C.
};

}  // namespace kerfbench::twin
