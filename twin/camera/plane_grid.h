// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "twin/camera/projection.h"

namespace kerfbench::twin {

/// A picture cut into blocks, and the piece of the plane that each of them sees.
class PlaneGrid {
 public:
  /// A block of pixels [x0, x1) x [y0, y1).
  struct Block {
    int x0{}, x1{}, y0{}, y1{};
  };

  /// Makes blocks of at most block_px in each direction. @throws std::invalid_argument if a pixel does not
  /// see the plane.
  PlaneGrid(const PlaneProjection& projection, int width_px, int height_px, int block_px);

  [[nodiscard]] std::size_t columns() const { return edges_x_.size() - 1; }
  [[nodiscard]] std::size_t rows() const { return edges_y_.size() - 1; }
  [[nodiscard]] const std::vector<int>& edgesX() const { return edges_x_; }
  [[nodiscard]] const std::vector<int>& edgesY() const { return edges_y_; }
  [[nodiscard]] Block block(std::size_t column, std::size_t row) const {
    return {edges_x_[column], edges_x_[column + 1], edges_y_[row], edges_y_[row + 1]};
  }
  /// Points seen at the block's corners, middles and centre; its pixel centres lie at s = (x - x0 + 0.5) /
  /// (x1 - x0).
  [[nodiscard]] PlanePatch::Nodes nodes(std::size_t column, std::size_t row) const;

 private:
  std::vector<int> edges_x_;
  std::vector<int> edges_y_;
  std::vector<Eigen::Vector2d> points_;
};

}  // namespace kerfbench::twin
