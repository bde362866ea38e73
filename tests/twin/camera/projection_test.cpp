// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/projection.h"

#include <vector>

#include <gtest/gtest.h>
#include <Eigen/LU>
#include <opencv2/calib3d.hpp>

#include "tests/twin/camera/cameras.h"

namespace kerfbench::twin {
namespace {

using Eigen::Vector2d;

TEST(PlaneProjection, AgreesWithOpenCv) {
  const CameraDescription camera = cameraAbove(2048, 1536, 0.04);
  const PlaneProjection projection(camera);
  cv::Mat rotation(3, 3, CV_64F);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) rotation.at<double>(r, c) = camera.X_CP.linear()(r, c);
  }
  cv::Mat rotation_vector;
  cv::Rodrigues(rotation, rotation_vector);
  const Eigen::Vector3d t = camera.X_CP.translation();
  const cv::Matx33d matrix(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  const std::vector<double> distortion(camera.distortion.begin(), camera.distortion.end());
  std::vector<cv::Point3d> points;
  for (double x = -40; x <= 40; x += 8) {
    for (double y = -30; y <= 30; y += 6) points.emplace_back(x, y, 0.0);
  }
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, rotation_vector, cv::Vec3d(t.x(), t.y(), t.z()), matrix, distortion, pixels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto pixel = projection.pixelOf({points[i].x, points[i].y});
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), pixels[i].x, 1e-8);
    EXPECT_NEAR(pixel->y(), pixels[i].y, 1e-8);
  }
}

TEST(PlaneProjection, TheWayBackFindsThePoint) {
  for (const double mm_per_px : {0.04, 0.1, 0.3}) {
    const PlaneProjection projection(cameraAbove(1800, 1800, mm_per_px));
    for (int u = 0; u < 1800; u += 97) {
      for (int v = 0; v < 1800; v += 97) {
        const auto point = projection.planePointOf(Vector2d(u, v));
        ASSERT_TRUE(point) << u << " " << v;
        const auto pixel = projection.pixelOf(*point);
        ASSERT_TRUE(pixel);
        EXPECT_LT((*pixel - Vector2d(u, v)).norm(), 1e-8);
      }
    }
  }
}

TEST(PlaneProjection, ItsJacobianIsTheSlopeOfTheMap) {
  const PlaneProjection projection(cameraAbove(1800, 1800, 0.1));
  const double h = 1e-4;
  for (const Vector2d& p : {Vector2d(0, 0), Vector2d(70, -60), Vector2d(-80, 33)}) {
    const Eigen::Matrix2d J = projection.jacobianAt(p);
    for (int axis = 0; axis < 2; ++axis) {
      const Vector2d step = h * Vector2d::Unit(axis);
      const Vector2d slope = (*projection.pixelOf(p + step) - *projection.pixelOf(p - step)) / (2.0 * h);
      EXPECT_LT((J.col(axis) - slope).norm(), 1e-6);
    }
  }
}

TEST(PlaneProjection, APointFarOutsideDoesNotFoldIntoThePicture) {
  CameraDescription camera = cameraAbove(1800, 1800, 0.1, 0.0);
  camera.distortion = {-0.3, 0.0, 0.0, 0.0, 0.0};
  const PlaneProjection projection(camera);
  // The function r (1 - 0.3 r²) is back at 0 for r = 1.83, 913 mm off the axis.
  EXPECT_FALSE(projection.pixelOf({913.0, 0.0}));
  EXPECT_TRUE(projection.pixelOf({85.0, 0.0}));
}

TEST(PlaneProjection, NothingIsSeenBehindTheCameraOrBesideThePlane) {
  CameraDescription camera = cameraAbove(1800, 1800, 0.1, 0.0);
  camera.distortion = {};
  camera.X_CP = Eigen::Translation3d(0, 0, 100) * Eigen::AngleAxisd(1.3, Eigen::Vector3d::UnitX());
  const PlaneProjection projection(camera);
  EXPECT_FALSE(projection.pixelOf({0.0, -200.0}));
  EXPECT_FALSE(projection.planePointOf({camera.cx_px, camera.cy_px + 3.0 * camera.fy_px}));
}

TEST(PlanePatch, FollowsTheMapOverABlock) {
  const PlaneProjection projection(cameraAbove(2048, 1536, 0.04));
  PlanePatch::Nodes nodes;
  const Vector2d corner(1990.0, 20.0);
  const double side = 40.0;
  for (std::size_t n = 0; n < 9; ++n) {
    nodes[n] = *projection.planePointOf(
        corner + 0.5 * side * Vector2d(static_cast<double>(n % 3), static_cast<double>(n / 3)));
  }
  const PlanePatch patch(nodes);
  for (double s = 0.0; s <= 1.0; s += 0.13) {
    for (double t = 0.0; t <= 1.0; t += 0.17) {
      EXPECT_LT((patch.at(s, t) - *projection.planePointOf(corner + side * Vector2d(s, t))).norm(), 1e-5);
    }
  }
}

TEST(PlaneField, EveryPointOfTheInscribedBoxIsInThePicture) {
  for (const double turn_rad : {0.0, 0.5 * std::numbers::pi, std::numbers::pi}) {
    CameraDescription camera = cameraAbove(2048, 1536, 0.04);
    camera.X_CP = camera.X_CP * Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ());
    const PlaneProjection projection(camera);
    const PlaneField field = fieldOf(projection, camera.width_px, camera.height_px);
    EXPECT_GT(field.inscribed.volume(), 0.8 * 2048 * 1536 * 0.04 * 0.04);
    for (double s = 0.0; s <= 1.0; s += 0.05) {
      for (double t = 0.0; t <= 1.0; t += 0.05) {
        const Vector2d p = field.inscribed.min() + field.inscribed.sizes().cwiseProduct(Vector2d(s, t));
        const auto pixel = projection.pixelOf(p);
        ASSERT_TRUE(pixel);
        EXPECT_TRUE(pixel->x() >= -0.6 && pixel->x() <= 2047.6 && pixel->y() >= -0.6 && pixel->y() <= 1535.6)
            << pixel->transpose();
      }
    }
  }
}

}  // namespace
}  // namespace kerfbench::twin
