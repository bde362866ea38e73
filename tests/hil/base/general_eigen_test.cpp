// SPDX-License-Identifier: Apache-2.0
#include "twin/base/general_eigen.h"

#include <complex>
#include <cstdint>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "twin/base/random.h"

namespace kerfbench {
namespace {

TEST(GeneralEigen, IsEigensOwnToTheBitAndGivesBackTheMatrix) {
  const CounterRandom random(12, 0);
  std::uint64_t next = 0;
  for (Eigen::Index size = 1; size <= 20; ++size) {
    Eigen::MatrixXd matrix(size, size);
    for (double& element : matrix.reshaped()) element = random.normal(next++);
    const Eigen::EigenSolver<Eigen::MatrixXd> expected(matrix);
    const GeneralEigen eigen(matrix);
    EXPECT_EQ(eigen.values, expected.eigenvalues()) << size;
    EXPECT_EQ(eigen.vectors, expected.eigenvectors()) << size;
    EXPECT_LT(
        (matrix.cast<std::complex<double>>() * eigen.vectors - eigen.vectors * eigen.values.asDiagonal())
            .norm(),
        1e-12 * matrix.norm())
        << size;
  }
}

}  // namespace
}  // namespace kerfbench
