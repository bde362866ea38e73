// SPDX-License-Identifier: Apache-2.0
#include "hil/inspect/evidence/print_error.h"

#include <Eigen/Cholesky>

namespace kerfbench::inspect {
namespace {

/// How a shift and a turn about the origin move a place.
Eigen::Matrix<double, 2, 3> moved(const Eigen::Vector2d& p_mm) {
  Eigen::Matrix<double, 2, 3> J;
  J << 1.0, 0.0, -p_mm.y(), 0.0, 1.0, p_mm.x();
  return J;
}

}  // namespace

Eigen::Matrix2Xd printInfluence(const PrintLayout& print, const std::vector<std::size_t>& seen,
                                const Eigen::Vector2d& p_S_mm) {
  Eigen::Matrix2Xd influence = Eigen::Matrix2Xd::Zero(2, 2 * static_cast<Eigen::Index>(print.marks.size()));
  const auto columnOf = [](std::size_t mark) { return 2 * static_cast<Eigen::Index>(mark); };
  if (seen.size() == 1) influence.middleCols<2>(columnOf(seen.front())).setIdentity();
  if (seen.size() < 2) return influence;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  for (const std::size_t mark : seen) {
    const auto J = moved(print.marks[mark].p_SM_mm);
    normal += J.transpose() * J;
  }
  const Eigen::Matrix<double, 2, 3> at_place = moved(p_S_mm);
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
  for (const std::size_t mark : seen) {
    influence.middleCols<2>(columnOf(mark)) =
        at_place * solver.solve(moved(print.marks[mark].p_SM_mm).transpose());
  }
  return influence;
}

}  // namespace kerfbench::inspect
