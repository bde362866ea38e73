// SPDX-License-Identifier: Apache-2.0
#pragma once

// Private to this room: units of files.

#include <numbers>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::fold {

inline constexpr double kDegree = std::numbers::pi / 180.0;  ///< rad
inline constexpr double kMicron_mm = 1e-3;

/// A list of three numbers.
inline Eigen::Vector3d vectorOf(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace kerfbench::fold
