// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "twin/base/print_layout.h"

namespace kerfbench::inspect {

/// What misprinted marks do to a place on a unit whose pose was fitted to them by least squares: the place is
/// reported off by this matrix times the marks' own errors. 2 x 2n for the n marks of the layout (x and y of
/// the first, of the second, ...); columns of marks that were not `seen` are zero. With one mark the angle is
/// taken from elsewhere. Frame S of the unit.
Eigen::Matrix2Xd printInfluence(const PrintLayout& print, const std::vector<std::size_t>& seen,
                                const Eigen::Vector2d& p_S_mm);

}  // namespace kerfbench::inspect
