// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kerfbench {

/// Eigenvalues and eigenvectors of a real square matrix A = V diag(values) V⁻¹, by Hessenberg's form and
/// implicit QR steps (Eigen's EigenSolver).
///
/// Compiled once, in general_eigen.cpp: the decomposition costs a compiler nine seconds in each source that
/// includes <Eigen/Eigenvalues> for it. Results are those of Eigen's class to the bit.
struct GeneralEigen {
  /// `matrix` must be finite.
  explicit GeneralEigen(const Eigen::MatrixXd& matrix);

  Eigen::VectorXcd values;   ///< In no order; conjugates follow each other.
  Eigen::MatrixXcd vectors;  ///< Column k belongs to value k; of length 1.
};

}  // namespace kerfbench
