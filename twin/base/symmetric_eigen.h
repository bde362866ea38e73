// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kerfbench {

/// Eigenvalues and eigenvectors of a real symmetric matrix A = V diag(values) Vᵀ, by Householder's
/// tridiagonal form and implicit QR steps (Eigen's SelfAdjointEigenSolver).
///
/// Compiled once, in symmetric_eigen.cpp, for N = 2 and 3: the decomposition costs a compiler seconds in each
/// source that includes <Eigen/Eigenvalues> for it. Results are those of Eigen's class to the bit.
template <int N>
struct SymmetricEigen {
  /// Reads A's lower triangle alone.
  explicit SymmetricEigen(const Eigen::Matrix<double, N, N>& matrix);

  Eigen::Matrix<double, N, 1> values;   ///< Eigenvalues in ascending order.
  Eigen::Matrix<double, N, N> vectors;  ///< Eigenvectors: column k belongs to value k and has length 1.
};

extern template struct SymmetricEigen<2>;
extern template struct SymmetricEigen<3>;

}  // namespace kerfbench
