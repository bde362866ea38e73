// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/raster.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace kerfbench::scene {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kGridWidth = 60;
constexpr int kGridHeight = 40;
constexpr int kSamples = 2;

// Looks along +Wy from in front of a wall at y = 0.
Viewpoint inFrontOfAWall() {
  return Viewpoint::around({{-30, 0, -20}, {30, 0, 20}}, {0, 1, -0.3}, kGridWidth, kGridHeight, 0.9);
}

// The wall as four triangles about a point of it, all seen from -Wy; each is a face of its own.
Mesh wall(const Vector2d& middle) {
  const Vector3d m(middle.x(), 0, middle.y());
  const Vector3d corners[] = {{-30, 0, -20}, {30, 0, -20}, {30, 0, 20}, {-30, 0, 20}};
  Mesh mesh;
  for (int i = 0; i < 4; ++i) {
    mesh.triangles.push_back({{m, corners[i], corners[(i + 1) % 4]}, i});
    mesh.faces.emplace_back();
  }
  return mesh;
}

std::vector<SeenTriangle> seen(const Mesh& mesh, const Viewpoint& view, Sides sides = Sides::kFront) {
  return seenTriangles(mesh, view, kSamples, std::vector<Sides>(mesh.faces.size(), sides));
}

TEST(Raster, TrianglesThatShareEdgesShareNoSampleAndLeaveNoneOut) {
  const Viewpoint view = inFrontOfAWall();
  for (const Vector2d& middle : {Vector2d(0, 0), Vector2d(7.3, -4.1), Vector2d(-29, 19.5)}) {
    std::vector<int> covered(static_cast<std::size_t>(kSamples * kGridWidth * kSamples * kGridHeight));
    for (const SeenTriangle& triangle : seen(wall(middle), view)) {
      forEachSpan(
          triangle, kSamples * kGridWidth, 0, kSamples * kGridHeight, [&](int row, int first, int past) {
            for (int x = first; x < past; ++x)
              ++covered[static_cast<std::size_t>(row) * kSamples * kGridWidth + static_cast<std::size_t>(x)];
          });
    }
    const Vector2d low = *view.project({-30, 0, 20});
    const Vector2d high = *view.project({30, 0, -20});
    for (int y = 0; y < kSamples * kGridHeight; ++y) {
      // Sides of the wall run together farther down: the narrower end is the inside of both.
      const double row_px = (y + 0.5) / kSamples - 0.5;
      for (int x = 0; x < kSamples * kGridWidth; ++x) {
        const double px = (x + 0.5) / kSamples - 0.5;
        const int count =
            covered[static_cast<std::size_t>(y) * kSamples * kGridWidth + static_cast<std::size_t>(x)];
        EXPECT_LE(count, 1);
        const bool inside = row_px > low.y() && row_px < high.y() &&
                            px > std::max(low.x(), view.project({-30, 0, -20})->x()) &&
                            px < std::min(high.x(), view.project({30, 0, 20})->x());
        if (inside) EXPECT_EQ(count, 1) << x << ", " << y;
      }
    }
  }
}

TEST(Raster, NearnessIsOneOverTheDepthOfThePointThatIsSeen) {
  const Viewpoint view = inFrontOfAWall();
  DepthRows rows(kSamples * kGridWidth, kSamples * kGridHeight);
  rows.begin(0);
  for (const SeenTriangle& triangle : seen(wall({5, 5}), view)) rows.draw(triangle);
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(-20, 0, 15), Vector3d(11, 0, -12)}) {
    const Vector2d at = *view.project(p);
    const int x = static_cast<int>(std::lround(kSamples * (at.x() + 0.5) - 0.5));
    const int y = static_cast<int>(std::lround(kSamples * (at.y() + 0.5) - 0.5));
    const double depth_mm = (p - view.place_mm()).dot(view.forward());
    const float nearness = rows.nearness(rows.at(y) + static_cast<std::size_t>(x));
    EXPECT_NEAR(1.0 / static_cast<double>(nearness), depth_mm, 0.5);
  }
}

TEST(Raster, TheNearestFaceIsSeenInWhicheverOrderTheyCome) {
  const Viewpoint view = inFrontOfAWall();
  Mesh mesh = wall({0, 0});
  const std::size_t walls = mesh.triangles.size();
  mesh.faces.emplace_back();
  // A smaller one before the wall.
  mesh.triangles.push_back({{Vector3d(-5, -3, -5), Vector3d(5, -3, -5), Vector3d(0, -3, 5)}, 4});
  const Vector2d middle = *view.project({0, -3, -1});
  const auto faceInTheMiddle = [&] {
    DepthRows rows(kSamples * kGridWidth, kSamples * kGridHeight);
    rows.begin(0);
    for (const SeenTriangle& triangle : seen(mesh, view)) rows.draw(triangle);
    return rows.face(rows.at(kSamples * static_cast<int>(middle.y())) +
                     static_cast<std::size_t>(kSamples * static_cast<int>(middle.x())));
  };
  EXPECT_EQ(faceInTheMiddle(), 4);
  std::swap(mesh.triangles.front(), mesh.triangles[walls]);
  EXPECT_EQ(faceInTheMiddle(), 4);
}

TEST(Raster, BacksAreLeftOutUnlessBothSidesAreWanted) {
  const Viewpoint view = inFrontOfAWall();
  Mesh mesh = wall({0, 0});
  for (Triangle& t : mesh.triangles) std::swap(t.corners_W_mm[1], t.corners_W_mm[2]);
  EXPECT_TRUE(seen(mesh, view).empty());
  EXPECT_EQ(seen(mesh, view, Sides::kBoth).size(), 4U);
  EXPECT_TRUE(seen(mesh, view, Sides::kNone).empty());
}

TEST(Raster, WhatIsBehindTheEyeIsCutOff) {
  const Viewpoint view = inFrontOfAWall();
  const Vector3d eye = view.place_mm();
  Mesh mesh;
  mesh.faces.emplace_back();
  // A floor below the eye from far behind it to far before it.
  const Vector3d below = eye - 10.0 * view.up();
  const Vector3d ahead = 500.0 * view.forward();
  const Vector3d right = 400.0 * view.right();
  mesh.triangles.push_back({{below - ahead - right, below - ahead + right, below + ahead}, 0});
  const auto floor = seen(mesh, view, Sides::kBoth);
  ASSERT_FALSE(floor.empty());
  for (const SeenTriangle& triangle : floor) {
    EXPECT_GT(triangle.nearest, 0.0);
    for (const Vector2d& corner : triangle.corners) {
      EXPECT_TRUE(corner.allFinite());
      EXPECT_GT(corner.y(), 0.5 * kSamples * kGridHeight - 1.0) << "nothing of a floor is above the horizon";
    }
  }
  for (Vector3d& p : mesh.triangles[0].corners_W_mm) p -= 1000.0 * view.forward();
  EXPECT_TRUE(seen(mesh, view, Sides::kBoth).empty());
}

}  // namespace
}  // namespace kerfbench::scene
