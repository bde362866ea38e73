// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <variant>

namespace kerfbench::scene {
namespace {

using Eigen::Vector3d;

using Shape = std::variant<twin::Box, twin::Cylinder, twin::Disc, twin::Cone>;

Mesh meshOfOne(const Shape& shape, twin::Material material = twin::Material::kSteel) {
  Eigen::Isometry3d X_WP = Eigen::Isometry3d::Identity();
  X_WP.translation() = Vector3d(30, -20, 50);
  X_WP.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  twin::Scene scene;
  scene.parts.push_back({"part", material, X_WP, shape});
  return meshOf(scene);
}

// Sum of the tetrahedra between the faces and the origin: right only if every face looks outwards.
double volume_mm3(const Mesh& mesh) {
  double volume = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const auto& [a, b, c] = t.corners_W_mm;
    volume += a.dot(b.cross(c)) / 6.0;
  }
  return volume;
}

// Edges that no neighbour runs along in the other direction.
int openEdges(const Mesh& mesh) {
  using Point = std::array<long, 3>;
  const auto rounded = [](const Vector3d& p) {
    return Point{std::lround(p.x() * 1e4), std::lround(p.y() * 1e4), std::lround(p.z() * 1e4)};
  };
  std::map<std::pair<Point, Point>, int> edges;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Point a = rounded(t.corners_W_mm[i]);
      const Point b = rounded(t.corners_W_mm[(i + 1) % 3]);
      ++edges[{a, b}];
      --edges[{b, a}];
    }
  }
  int open = 0;
  for (const auto& [edge, count] : edges) open += count > 0 ? 1 : 0;
  return open;
}

TEST(Mesh, EveryShapeIsClosedAndHasItsVolume) {
  const double pi = std::numbers::pi;
  const std::pair<Shape, double> cases[] = {
      {twin::Box{{10, 20, 30}, 0.0}, 6000.0},       {twin::Box{{10, 20, 30}, 2.0}, 6000.0},
      {twin::Cylinder{10, 40, 0.0}, pi * 100 * 40}, {twin::Cylinder{10, 40, 6.0}, pi * (100 - 36) * 40},
      {twin::Disc{{10, 5}, 2.0}, pi * 50 * 2},      {twin::Cone{10, 30}, pi * 100 * 30 / 3},
  };
  for (const auto& [shape, expected] : cases) {
    const Mesh mesh = meshOfOne(shape);
    EXPECT_EQ(openEdges(mesh), 0) << shape.index();
    EXPECT_NEAR(volume_mm3(mesh), expected, 0.004 * expected) << shape.index();
  }
}

TEST(Mesh, NormalsAreThoseOfTheFaceAndOfLengthOne) {
  for (const Shape& shape :
       {Shape(twin::Box{{10, 20, 30}, 0.0}), Shape(twin::Box{{10, 20, 30}, 2.0}),
        Shape(twin::Cylinder{10, 40, 6.0}), Shape(twin::Disc{{10, 10}, 2.0}), Shape(twin::Cone{10, 30})}) {
    for (const Mesh mesh = meshOfOne(shape); const Triangle& t : mesh.triangles) {
      const auto& [a, b, c] = t.corners_W_mm;
      const Vector3d middle = (a + b + c) / 3.0;
      const Vector3d normal = mesh.faces[static_cast<std::size_t>(t.face)].normalAt(middle);
      EXPECT_NEAR(normal.norm(), 1.0, 1e-12);
      EXPECT_GT(normal.dot((b - a).cross(c - a).normalized()), 0.995) << shape.index();
    }
  }
}

TEST(Mesh, ARoundedBoxLooksOutwardsAtItsEdgeAndStraightInTheMiddle) {
  Face face;
  face.kind = Face::Kind::kRoundedEdge;
  face.core_mm = {3, 8, 13};
  EXPECT_TRUE(face.normalAt({0, 0, 15}).isApprox(Vector3d::UnitZ()));
  EXPECT_TRUE(face.normalAt({5, 0, 15}).isApprox(Vector3d(1, 0, 1).normalized()));
}

TEST(Mesh, ATubeShowsItsDischargeWhileTheLaserIsLit) {
  twin::Scene scene;
  scene.parts.push_back(
      {"laser tube", twin::Material::kTube, Eigen::Isometry3d::Identity(), twin::Cylinder{10, 100, 0.0}});
  const auto has = [&](Look look) {
    const Mesh mesh = meshOf(scene);
    for (const Face& face : mesh.faces) {
      if (face.look == look) return true;
    }
    return false;
  };
  EXPECT_TRUE(has(Look::kBore));
  EXPECT_FALSE(has(Look::kDischarge));
  scene.beam_on = true;
  EXPECT_FALSE(has(Look::kBore));
  EXPECT_TRUE(has(Look::kDischarge));
  EXPECT_TRUE(has(Look::kTube));
}

}  // namespace
}  // namespace kerfbench::scene
