// SPDX-License-Identifier: Apache-2.0
#include "twin/base/general_eigen.h"

#include <Eigen/Eigenvalues>

namespace kerfbench {

GeneralEigen::GeneralEigen(const Eigen::MatrixXd& matrix) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
  values = solver.eigenvalues();
  vectors = solver.eigenvectors();
}

}  // namespace kerfbench
