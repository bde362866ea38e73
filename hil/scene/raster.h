// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "hil/scene/mesh.h"
#include "hil/scene/view.h"

namespace kerfbench::scene {

/// A triangle as a viewpoint sees it, on a grid of samples: `samples` each way in a pixel, sample centres at
/// integers.
struct SeenTriangle {
  std::array<Eigen::Vector2d, 3> corners;
  /// One over the depth, which is linear in the picture: nearness = slope * (x, y) + offset.
  Eigen::Vector2d slope{Eigen::Vector2d::Zero()};
  double offset{};
  double nearest{};        ///< Largest nearness of a corner.
  double top{}, bottom{};  ///< Range of rows.
  int face{};
};

/// Which sides of a face are wanted.
enum class Sides { kNone, kFront, kBoth };

/// Triangles in front of the viewpoint, cut off where they come too near to it, with `samples` each way in a
/// pixel. `sides_of_faces`: one for each face of the mesh.
std::vector<SeenTriangle> seenTriangles(const Mesh& mesh, const Viewpoint& view, int samples,
                                        const std::vector<Sides>& sides_of_faces);

/// Calls `span(row, first, end)` for every row from `first_row` to before `end_row` with the samples whose
/// centres the triangle covers, within 0 … width. Triangles that share an edge share no sample and leave none
/// out.
template <typename Span>
void forEachSpan(const SeenTriangle& triangle, int width, int first_row, int end_row, Span&& span) {
  const auto rowAfter = [&](double y) {
    return static_cast<int>(std::ceil(std::clamp<double>(y, first_row, end_row)));
  };
  const int end = rowAfter(triangle.bottom);
  for (int row = rowAfter(triangle.top); row < end; ++row) {
    double low = 1e300;
    double high = -1e300;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector2d* a = &triangle.corners[i];
      const Eigen::Vector2d* b = &triangle.corners[(i + 1) % 3];
      if (a->y() > b->y()) std::swap(a, b);  // The same numbers for both triangles at an edge.
      if (!(a->y() <= row && row < b->y())) continue;
      const double x = a->x() + (row - a->y()) * ((b->x() - a->x()) / (b->y() - a->y()));
      low = std::min(low, x);
      high = std::max(high, x);
    }
    if (!(low < width && high > 0)) continue;
    const int first = static_cast<int>(std::ceil(std::max(low, 0.0)));
    const int past = static_cast<int>(std::ceil(std::min<double>(high, width)));
    if (first < past) span(row, first, past);
  }
}

/// Rows of samples, each with the nearest face and its nearness.
class DepthRows {
 public:
  DepthRows(int width, int rows)
      : width_(width),
        rows_(rows),
        nearness_(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows)),
        face_(nearness_.size()) {}

  /// Empties it; its first row becomes `first_row`.
  void begin(int first_row) {
    first_row_ = first_row;
    std::ranges::fill(nearness_, 0.0F);
    std::ranges::fill(face_, -1);
  }
  void draw(const SeenTriangle& triangle);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int first_row() const { return first_row_; }
  /// Index of the first sample of a row.
  [[nodiscard]] std::size_t at(int row) const {
    return static_cast<std::size_t>(row - first_row_) * static_cast<std::size_t>(width_);
  }
  [[nodiscard]] float nearness(std::size_t i) const { return nearness_[i]; }  ///< 0: nothing is there.
  [[nodiscard]] int face(std::size_t i) const { return face_[i]; }            ///< -1: nothing is there.

 private:
  int width_, rows_;
  int first_row_{};
  std::vector<float> nearness_;
  std::vector<int> face_;
};

}  // namespace kerfbench::scene
