// SPDX-License-Identifier: Apache-2.0
// Which of a unit's pictures show a place.
#include "hil/vision/kerf/kerf_tiles.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/hil/vision/synthetic.h"

namespace kerfbench::vision {
namespace {

constexpr double kPitch_mm = 0.05;
constexpr int kWidth_px = 400;
constexpr int kHeight_px = 40;

/// A camera on wide pictures, the middle of which is not what it calls the origin.
CameraCalibration wideCamera() {
  CameraCalibration camera = test::tiltedCamera(kWidth_px, kHeight_px, kPitch_mm);
  camera.X_CP.translation().x() += 6.0;
  return camera;
}

TileView viewAt(const CameraCalibration& camera, const Eigen::Vector2d& p_TV_mm) {
  return viewTile({GrayImage(kWidth_px, kHeight_px, 60), p_TV_mm, 0}, camera, {});
}

TEST(KerfTiles, ReachAsFarAsTheirFarthestCorner) {
  const CameraCalibration camera = wideCamera();
  const TileView view = viewAt(camera, {30.0, 20.0});
  ASSERT_GT(camera.planeFromPixel({0.5 * (kWidth_px - 1), 0.5 * (kHeight_px - 1)}).norm(), 3.0);
  double farthest_mm = 0.0;
  for (const double x_px : {0.0, kWidth_px - 1.0}) {
    for (const double y_px : {0.0, kHeight_px - 1.0}) {
      const Eigen::Vector2d p_T_mm = view.tile.p_TV_mm + camera.planeFromPixel({x_px, y_px});
      farthest_mm = std::max(farthest_mm, (p_T_mm - view.centre_T_mm).norm());
    }
  }
  EXPECT_NEAR(view.half_diagonal_mm, farthest_mm, 1e-9);
}

TEST(KerfTiles, EveryPlaceThatAPictureShowsIsFound) {
  const CameraCalibration camera = wideCamera();
  // However the second lies to the first, and so whatever of a cell of the index is left at its rim.
  for (const Eigen::Vector2d& step_mm :
       {Eigen::Vector2d(2.0, 0.3), Eigen::Vector2d(4.1, -1.0), Eigen::Vector2d(-13.0, 6.2)}) {
    const std::vector<TileView> tiles{viewAt(camera, {30.0, 20.0}),
                                      viewAt(camera, Eigen::Vector2d(30.0, 20.0) + step_mm)};
    const TileIndex index(tiles, camera);
    for (const TileView& view : tiles) {
      for (double x_px = 1.0; x_px < kWidth_px - 1.0; x_px += 3.0) {
        for (const double y_px : {1.0, 20.0, kHeight_px - 2.0}) {
          const Eigen::Vector2d p_T_mm = view.tile.p_TV_mm + camera.planeFromPixel({x_px, y_px});
          EXPECT_NE(index.best(p_T_mm, 0.5), nullptr) << x_px << ", " << y_px;
        }
      }
    }
  }
}

}  // namespace
}  // namespace kerfbench::vision
