// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include <Eigen/Core>

namespace kerfbench::vision {

/// Gray of board and ink, and how the light changes over the picture: share per pixel of that at the disc's
/// centre.
struct MarkLevels {
  double board{};
  double ink{};
  Eigen::Vector2d slope{Eigen::Vector2d::Zero()};
  double pictures{1.0};  ///< Number of pictures that these are the mean of.

  [[nodiscard]] double contrast() const { return board - ink; }
  /// Takes in what another picture shows; what was seen longer ago than `most` pictures fades away.
  void average(const MarkLevels& another, double most) {
    pictures = std::min(pictures + 1.0, most);
    board += (another.board - board) / pictures;
    ink += (another.ink - ink) / pictures;
    slope += (another.slope - slope) / pictures;
  }
};

}  // namespace kerfbench::vision
