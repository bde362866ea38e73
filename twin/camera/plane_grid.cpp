// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/plane_grid.h"

#include <stdexcept>

namespace kerfbench::twin {
namespace {

/// Cuts `size` pixels into blocks of at most block_px; returns the first pixel of each, and `size`.
std::vector<int> blockEdges(int size, int block_px) {
  const int blocks = (size + block_px - 1) / block_px;
  std::vector<int> edges;
  for (int b = 0; b <= blocks; ++b) edges.push_back(size * b / blocks);
  return edges;
}

}  // namespace

PlaneGrid::PlaneGrid(const PlaneProjection& projection, int width_px, int height_px, int block_px)
    : edges_x_(blockEdges(width_px, block_px)), edges_y_(blockEdges(height_px, block_px)) {
  const auto nodeAt = [](const std::vector<int>& edges, std::size_t i) {
    return 0.5 * (edges[i / 2] + edges[(i + 1) / 2]) - 0.5;
  };
  for (std::size_t j = 0; j < 2 * edges_y_.size() - 1; ++j) {
    for (std::size_t i = 0; i < 2 * edges_x_.size() - 1; ++i) {
      const auto point = projection.planePointOf({nodeAt(edges_x_, i), nodeAt(edges_y_, j)});
      if (!point) throw std::invalid_argument("camera: a pixel does not see the plane");
      points_.push_back(*point);
    }
  }
}

PlanePatch::Nodes PlaneGrid::nodes(std::size_t column, std::size_t row) const {
  const std::size_t stride = 2 * edges_x_.size() - 1;
  PlanePatch::Nodes nodes;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    nodes[n] = points_[(2 * row + n / 3) * stride + 2 * column + n % 3];
  return nodes;
}

}  // namespace kerfbench::twin
