// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kerfbench::vision {

/// Gray of board and ink, and how the light changes over the picture: share per pixel of that at the disc's
/// centre.
struct MarkLevels {
  double board{};
  double ink{};
  Eigen::Vector2d slope{Eigen::Vector2d::Zero()};

  [[nodiscard]] double contrast() const { return board - ink; }
};

}  // namespace kerfbench::vision
