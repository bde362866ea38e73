// SPDX-License-Identifier: Apache-2.0
#include "twin/base/symmetric_eigen.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "twin/base/random.h"

namespace kerfbench {
namespace {

// Symmetric matrices of very different scales, some of them singular.
template <int N>
void expectEigensOwn() {
  const CounterRandom random(11, N);
  std::uint64_t next = 0;
  for (int round = 0; round < 300; ++round) {
    Eigen::Matrix<double, N, N> root;
    for (double& element : root.reshaped()) element = random.normal(next++) * std::pow(10.0, round % 13 - 6);
    if (round % 5 == 0) root.col(1) = 2.0 * root.col(0);
    const Eigen::Matrix<double, N, N> matrix = root * root.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, N, N>> expected(matrix);
    const SymmetricEigen<N> eigen(matrix);
    EXPECT_EQ(eigen.values, expected.eigenvalues()) << round;
    EXPECT_EQ(eigen.vectors, expected.eigenvectors()) << round;
    const Eigen::Matrix<double, N, N> again =
        eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose();
    EXPECT_LT((again - matrix).norm(), 1e-13 * matrix.norm()) << round;
  }
}

TEST(SymmetricEigen, IsEigensOwnToTheBitAndGivesBackTheMatrix) {
  expectEigensOwn<2>();
  expectEigensOwn<3>();
}

}  // namespace
}  // namespace kerfbench
