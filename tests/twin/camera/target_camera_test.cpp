// SPDX-License-Identifier: Apache-2.0
#include "twin/camera/target_camera.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gtest/gtest.h>
#include <Eigen/LU>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/twin/camera/cameras.h"
#include "twin/base/image.h"
#include "twin/camera/projection.h"

namespace kerfbench::twin {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

TargetBoard chessboard() {
  TargetBoard board;
  board.columns = 9;
  board.rows = 7;
  board.square_mm = 4.0;
  board.margin_mm = 3.0;
  return board;
}

/// Board whose white squares all hold a marker of 4 x 4 cells in a black border, each different.
TargetBoard boardWithMarkers() {
  TargetBoard board = chessboard();
  board.marker_mm = 3.0;
  board.marker_cells = 6;
  for (int row = 0; row < board.rows; ++row) {
    for (int column = (row + 1) % 2; column < board.columns; column += 2) {
      TargetMarker marker{column, row, std::vector<std::uint8_t>(36, 0)};
      const CounterRandom random(5, static_cast<std::uint64_t>(row * board.columns + column));
      for (std::size_t i = 0; i < 16; ++i) marker.white[7 + i % 4 + 6 * (i / 4)] = random.bits(i) & 1U;
      board.markers.push_back(marker);
    }
  }
  return board;
}

CameraDescription clearCamera() {
  CameraDescription camera = withoutNoise(cameraAbove(640, 480, 0.07));
  camera.bits = 12;
  return camera;
}

/// Pose of the board with its middle before the camera, turned about its own axes.
Isometry3d pose(double turn_rad, double tilt_x_rad, double tilt_y_rad, double away_mm = 500.0) {
  return Eigen::Translation3d(0.7, -0.4, away_mm) * Eigen::AngleAxisd(tilt_x_rad, Vector3d::UnitX()) *
         Eigen::AngleAxisd(tilt_y_rad, Vector3d::UnitY()) * Eigen::AngleAxisd(turn_rad, Vector3d::UnitZ()) *
         Eigen::Translation3d(-18.0, -14.0, 0.0);
}

PlaneProjection projectionAt(CameraDescription camera, const Isometry3d& X_CB) {
  camera.X_CP = X_CB;
  return PlaneProjection(camera);
}

TEST(TargetPattern, BlursAsADenseSumOverTheGaussianDoes) {
  const TargetPattern pattern(boardWithMarkers());
  TargetPattern::Scratch scratch;
  const CounterRandom random(3, 1);
  for (const double correlation : {-0.8, -0.3, 0.0, 0.5, 0.8}) {
    for (std::uint64_t i = 0; i < 6; ++i) {
      const Vector2d place(40.0 * random.uniform(2 * i) - 2.0, 32.0 * random.uniform(2 * i + 1) - 2.0);
      const double sx = 0.15, sy = 0.3;
      Matrix2d covariance;
      covariance << sx * sx, correlation * sx * sy, correlation * sx * sy, sy * sy;
      // The sum's axes are turned, so that the lattice's lines never run along them.
      const Matrix2d root = Matrix2d(covariance.llt().matrixL()) * Eigen::Rotation2Dd(0.5).toRotationMatrix();
      double sum = 0.0, weight = 0.0;
      for (double u = -4.6; u < 4.6; u += 0.0113) {
        for (double v = -4.6; v < 4.6; v += 0.0113) {
          const double w = std::exp(-0.5 * (u * u + v * v));
          weight += w;
          sum += w * pattern.grayAt(place + root * Vector2d(u, v));
        }
      }
      EXPECT_NEAR(pattern.blurredAt(place, covariance, scratch), sum / weight, 0.02)
          << correlation << " at " << place.transpose();
    }
  }
}

TEST(TargetPattern, IsAsSymmetricAboutACornerAsACornerIs) {
  const TargetPattern pattern(chessboard());
  TargetPattern::Scratch scratch;
  Matrix2d covariance;
  covariance << 0.002, 0.0011, 0.0011, 0.0015;
  const Vector2d corner(8.0, 12.0);
  for (const Vector2d& off : {Vector2d(0.0, 0.0), Vector2d(0.02, 0.01), Vector2d(-0.05, 0.03)}) {
    EXPECT_NEAR(pattern.blurredAt(corner + off, covariance, scratch),
                pattern.blurredAt(corner - off, covariance, scratch), 1e-9);
  }
  // The share of like colours about a corner is 1/2 + asin(correlation) / pi.
  const double correlation = 0.0011 / std::sqrt(0.002 * 0.0015);
  const bool like_is_black = pattern.grayAt(corner + Vector2d(0.1, 0.1)) < 100.0;
  const double like = 0.5 + std::asin(correlation) / std::numbers::pi;
  const double expected = like_is_black ? 200.0 - 180.0 * like : 20.0 + 180.0 * like;
  EXPECT_NEAR(pattern.blurredAt(corner, covariance, scratch), expected, 1e-5 * 180.0);
}

TEST(TargetPattern, PrintsWhatTheDescriptionSays) {
  const TargetBoard board = boardWithMarkers();
  const TargetPattern pattern(board);
  EXPECT_EQ(pattern.grayAt({1.0, 1.0}), 20.0);
  EXPECT_EQ(pattern.grayAt({4.2, 0.2}), 200.0);    // The place is near a marker.
  EXPECT_EQ(pattern.grayAt({4.6, 0.6}), 20.0);     // The place is in the marker's border.
  EXPECT_EQ(pattern.grayAt({-2.9, 10.0}), 200.0);  // The place is in the margin.
  EXPECT_EQ(pattern.grayAt({-3.1, 10.0}), 60.0);
  EXPECT_EQ(pattern.grayAt({36.5, 31.1}), 60.0);
  for (const TargetMarker& marker : board.markers) {
    for (int cell = 0; cell < 36; ++cell) {
      const Vector2d middle(4.0 * marker.column + 0.5 + 0.5 * (cell % 6 + 0.5),
                            4.0 * marker.row + 0.5 + 0.5 * (cell / 6 + 0.5));
      EXPECT_EQ(pattern.grayAt(middle), marker.white[static_cast<std::size_t>(cell)] != 0 ? 200.0 : 20.0);
    }
  }
}

struct Tilt {
  double turn_rad, tilt_x_rad, tilt_y_rad;
};
class TargetAt : public testing::TestWithParam<Tilt> {};

/// Corner by least squares: two blurred edges that cross. With a sample at every pixel, a picture this sharp
/// misleads estimators without a model by some 0.01 px, whatever its origin.
Vector2d cornerNear(const GrayImage& image, const Vector2d& truth, const Matrix2d& mm_per_px) {
  Vector2d found = truth + Vector2d(0.1, -0.1);
  const auto product = [&](const Vector2d& d) {
    const auto edge = [](double sigmas) { return std::erf(sigmas / std::numbers::sqrt2); };
    return edge(mm_per_px.row(0).dot(d) / (0.6 * mm_per_px.row(0).norm())) *
           edge(mm_per_px.row(1).dot(d) / (0.6 * mm_per_px.row(1).norm()));
  };
  for (int round = 0; round < 8; ++round) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (int dy = -6; dy <= 6; ++dy) {
      for (int dx = -6; dx <= 6; ++dx) {
        const Vector2d pixel = truth.array().round().matrix() + Vector2d(dx, dy);
        const Vector2d d = pixel - found;
        const double h = 1e-4;
        const double value = product(d);
        const Eigen::Vector4d terms(
            -90.0 * (product(d + Vector2d(h, 0)) - product(d - Vector2d(h, 0))) / (2 * h),
            -90.0 * (product(d + Vector2d(0, h)) - product(d - Vector2d(0, h))) / (2 * h), value, 1.0);
        normal += terms * terms.transpose();
        right += terms * image.gray(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
      }
    }
    const Eigen::Vector4d fit = normal.ldlt().solve(right);
    found += fit.head<2>() * 90.0 / fit[2];
  }
  return found;
}

TEST_P(TargetAt, CornersAreWhereTheirProjectionIs) {
  const CameraDescription description = clearCamera();
  const Tilt tilt = GetParam();
  const Isometry3d X_CB = pose(tilt.turn_rad, tilt.tilt_x_rad, tilt.tilt_y_rad);
  const GrayImage image = TargetCamera(description, chessboard(), 1).render(X_CB, 0);
  const PlaneProjection projection = projectionAt(description, X_CB);
  cv::Mat floats(image.height, image.width, CV_32F);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) floats.at<float>(y, x) = static_cast<float>(image.gray(x, y));
  }
  std::vector<Vector2d> truths;
  std::vector<cv::Point2f> refined;
  for (int j = 1; j < 7; ++j) {
    for (int i = 1; i < 9; ++i) {
      const Vector2d truth = *projection.pixelOf({4.0 * i, 4.0 * j});
      if (truth.x() < 15 || truth.y() < 15 || truth.x() > 624 || truth.y() > 464) continue;
      truths.push_back(truth);
      refined.emplace_back(static_cast<float>(truth.x() + 0.3), static_cast<float>(truth.y() - 0.2));
    }
  }
  ASSERT_GE(truths.size(), 40U);
  cv::cornerSubPix(floats, refined, {4, 4}, {-1, -1},
                   cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-5));
  Vector2d mean = Vector2d::Zero();
  double refined_squares = 0.0;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const Matrix2d mm_per_px = projection.jacobianAt(*projection.planePointOf(truths[i])).inverse();
    const Vector2d miss = cornerNear(image, truths[i], mm_per_px) - truths[i];
    EXPECT_LT(miss.norm(), 0.005) << i;
    mean += miss / static_cast<double>(truths.size());
    refined_squares += (Vector2d(refined[i].x, refined[i].y) - truths[i]).squaredNorm();
  }
  EXPECT_LT(mean.norm(), 0.001);
  EXPECT_LT(std::sqrt(refined_squares / static_cast<double>(truths.size())), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Poses, TargetAt,
                         testing::Values(Tilt{0.0, 0.0, 0.0}, Tilt{0.01, 0.0, 0.0}, Tilt{0.3, 0.3, 0.0},
                                         Tilt{0.785, 0.0, 0.4}, Tilt{-1.2, -0.5, 0.3}, Tilt{3.0, 0.2, -0.6}));

TEST(TargetCamera, AnEdgeIsABlurredStep) {
  const CameraDescription description = clearCamera();
  const Isometry3d X_CB = pose(0.4, 0.3, -0.2);
  const GrayImage image = TargetCamera(description, chessboard(), 1).render(X_CB, 0);
  const PlaneProjection projection = projectionAt(description, X_CB);
  // The edge is between two corners of the line x = 16 mm.
  int checked = 0;
  for (int y = 20; y < 460; ++y) {
    for (int x = 20; x < 620; ++x) {
      const Vector2d p = *projection.planePointOf(Vector2d(x, y));
      if (std::abs(p.x() - 16.0) > 0.3 || std::abs(p.y() - 10.0) > 1.0) continue;
      const Vector2d along_normal = projection.jacobianAt(p).inverse().transpose() * Vector2d::UnitX();
      const double sigmas = (p.x() - 16.0) / (0.6 * along_normal.norm());
      const double dark = 0.5 * std::erfc(-sigmas / std::numbers::sqrt2);
      EXPECT_NEAR(image.gray(x, y), 200.0 - 180.0 * dark, 0.2) << x << " " << y;
      ++checked;
    }
  }
  EXPECT_GT(checked, 100);
}

TEST(TargetCamera, AViewIsTheSameAloneAndNoTwoShareTheirNoise) {
  CameraDescription description = cameraAbove(200, 160, 0.2);
  const TargetCamera camera(description, boardWithMarkers(), 4);
  const Isometry3d X_CB = pose(0.1, 0.2, 0.0);
  const GrayImage first = camera.render(X_CB, 7);
  EXPECT_NE(camera.render(X_CB, 8).pixels, first.pixels);
  EXPECT_EQ(camera.render(X_CB, 7).pixels, first.pixels);
  EXPECT_NE(TargetCamera(description, boardWithMarkers(), 5).render(X_CB, 7).pixels, first.pixels);
  EXPECT_EQ(first.bits, 8);
  description.bits = 10;
  EXPECT_EQ(TargetCamera(description, boardWithMarkers(), 4).render(X_CB, 7).bits, 10);
}

TEST(TargetCamera, SeesWhatLiesAroundABoardThatEndsInView) {
  const CameraDescription description = clearCamera();
  const TargetCamera camera(description, chessboard(), 1);
  // The tilt is so steep that the plane's horizon crosses the picture.
  const GrayImage image = camera.render(pose(0.0, 1.545, 0.0), 0);
  EXPECT_EQ(image.gray(5, 5), 60.0);
  EXPECT_EQ(camera.render(pose(0.0, 0.0, 0.0, 5000.0), 0).gray(5, 5), 60.0);
}

TEST(TargetCamera, RefusesAPoseFromWhichNothingIsSeen) {
  const TargetCamera camera(clearCamera(), chessboard(), 1);
  EXPECT_THROW(static_cast<void>(camera.render(pose(0.0, 3.1, 0.0), 0)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(camera.render(pose(0.0, 0.0, 0.0, -500.0), 0)), std::invalid_argument);
  Isometry3d broken = pose(0.0, 0.0, 0.0);
  broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(static_cast<void>(camera.render(broken, 0)), std::invalid_argument);
}

TEST(TargetCamera, NamesEveryFaultOfBoardAndCamera) {
  TargetBoard board = boardWithMarkers();
  board.columns = 1;
  board.square_mm = 0.0;
  board.white_gray = 300.0;
  board.marker_cells = 40;
  CameraDescription description = clearCamera();
  description.bits = 9;
  try {
    const TargetCamera camera(description, board, 1);
    FAIL() << "accepted";
  } catch (const std::invalid_argument& fault) {
    const std::string text = fault.what();
    for (const char* name : {"columns", "square_mm", "white_gray", "marker_cells", "marker_mm", "bits"})
      EXPECT_NE(text.find(name), std::string::npos) << name << " in " << text;
  }
  board = boardWithMarkers();
  board.markers.front().column = 0;
  EXPECT_NE(faultsOf(board).find("white square"), std::string::npos);
}

}  // namespace
}  // namespace kerfbench::twin
