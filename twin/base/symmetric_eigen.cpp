// SPDX-License-Identifier: Apache-2.0
#include "twin/base/symmetric_eigen.h"

#include <Eigen/Eigenvalues>

namespace kerfbench {

template <int N>
SymmetricEigen<N>::SymmetricEigen(const Eigen::Matrix<double, N, N>& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> solver(matrix);
  values = solver.eigenvalues();
  vectors = solver.eigenvectors();
}

template struct SymmetricEigen<2>;
template struct SymmetricEigen<3>;

}  // namespace kerfbench
