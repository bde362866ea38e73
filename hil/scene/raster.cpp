// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/raster.h"

#include <Eigen/Geometry>

namespace kerfbench::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Corner in the viewpoint's axes: to the right, up, and depth, mm.
Vector3d inView(const Viewpoint& view, const Vector3d& p_W_mm) {
  const Vector3d q = p_W_mm - view.place_mm();
  return {q.dot(view.right()), q.dot(view.up()), q.dot(view.forward())};
}

/// What of the triangle is at least as deep as that: none, three or four corners in order.
std::vector<Vector3d> cutOff(const std::array<Vector3d, 3>& corners, double depth_mm) {
  std::vector<Vector3d> kept;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d& a = corners[i];
    const Vector3d& b = corners[(i + 1) % 3];
    if (a.z() >= depth_mm) kept.push_back(a);
    if ((a.z() >= depth_mm) != (b.z() >= depth_mm))
      kept.push_back(a + (depth_mm - a.z()) / (b.z() - a.z()) * (b - a));
  }
  return kept;
}

class Projection {
 public:
  Projection(const Viewpoint& view, int samples)
      : scale_(0.5 * view.width_px() * samples / view.half_width_tan()),
        middle_(0.5 * samples * Vector2d(view.width_px(), view.height_px()) - Vector2d(0.5, 0.5)) {}

  [[nodiscard]] Vector2d operator()(const Vector3d& q) const {
    return middle_ + scale_ / q.z() * Vector2d(q.x(), -q.y());
  }

 private:
  double scale_;
  Vector2d middle_;
};

}  // namespace

std::vector<SeenTriangle> seenTriangles(const Mesh& mesh, const Viewpoint& view, int samples,
                                        const std::vector<Sides>& sides_of_faces) {
  constexpr double kNearest_mm = 1.0;
  const Projection project(view, samples);
  std::vector<SeenTriangle> seen;
  for (const Triangle& triangle : mesh.triangles) {
    const Sides sides = sides_of_faces[static_cast<std::size_t>(triangle.face)];
    if (sides == Sides::kNone) continue;
    const auto& [a, b, c] = triangle.corners_W_mm;
    const bool in_front = (b - a).cross(c - a).dot(view.place_mm() - a) > 0;
    if (!in_front && sides != Sides::kBoth) continue;
    const std::vector<Vector3d> kept =
        cutOff({inView(view, a), inView(view, b), inView(view, c)}, kNearest_mm);
    for (std::size_t i = 2; i < kept.size(); ++i) {
      const std::array<Vector3d, 3> q{kept[0], kept[i - 1], kept[i]};
      SeenTriangle s;
      Eigen::Matrix3d plane;
      Vector3d nearness;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        s.corners[k] = project(q[k]);
        plane.row(row) << s.corners[k].x(), s.corners[k].y(), 1.0;
        nearness[row] = 1.0 / q[k].z();
      }
      // Twice the area: a triangle that is seen edge-on covers no sample worth the name.
      constexpr double kEdgeOn = 1e-6;
      if (!(std::abs(plane.determinant()) > kEdgeOn)) continue;
      const Vector3d law = plane.inverse() * nearness;
      s.slope = law.head<2>();
      s.offset = law[2];
      s.nearest = nearness.maxCoeff();
      s.top = std::min({s.corners[0].y(), s.corners[1].y(), s.corners[2].y()});
      s.bottom = std::max({s.corners[0].y(), s.corners[1].y(), s.corners[2].y()});
      s.face = triangle.face;
      seen.push_back(s);
    }
  }
  return seen;
}

void DepthRows::draw(const SeenTriangle& triangle) {
  const auto step = static_cast<float>(triangle.slope.x());
  const auto most = static_cast<float>(triangle.nearest);
  forEachSpan(triangle, width_, first_row_, first_row_ + rows_, [&](int row, int first, int past) {
    const std::size_t start = at(row);
    float* const nearness = nearness_.data() + start;
    int* const face = face_.data() + start;
    const auto begin =
        static_cast<float>(triangle.slope.x() * first + triangle.slope.y() * row + triangle.offset);
    for (int x = first; x < past; ++x) {
      const float near = std::min(begin + step * static_cast<float>(x - first), most);
      const bool nearer = near > nearness[x];
      nearness[x] = nearer ? near : nearness[x];
      face[x] = nearer ? triangle.face : face[x];
    }
  });
}

}  // namespace kerfbench::scene
