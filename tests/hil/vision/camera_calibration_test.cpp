// SPDX-License-Identifier: Apache-2.0
#include "hil/vision/image/camera_calibration.h"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "tests/hil/vision/synthetic.h"

namespace kerfbench::vision {
namespace {

std::vector<Eigen::Vector2d> pixelGrid(const CameraCalibration& c, double step_px) {
  std::vector<Eigen::Vector2d> pixels;
  for (double y = 0.0; y < c.height_px; y += step_px) {
    for (double x = 0.0; x < c.width_px; x += step_px) pixels.emplace_back(x, y);
  }
  return pixels;
}

TEST(CameraCalibration, PixelsGoToThePlaneAndBack) {
  const CameraCalibration camera = test::tiltedCamera(1800, 1800, 0.1);
  for (const Eigen::Vector2d& pixel : pixelGrid(camera, 101.3)) {
    EXPECT_LT((camera.pixelFromPlane(camera.planeFromPixel(pixel)) - pixel).norm(), 1e-9);
  }
}

TEST(CameraCalibration, AgreesWithOpenCv) {
  const CameraCalibration camera = test::tiltedCamera(1800, 1800, 0.1);
  const cv::Matx33d k(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  const std::vector<double> d(camera.distortion.begin(), camera.distortion.end());
  for (const Eigen::Vector2d& pixel : pixelGrid(camera, 211.7)) {
    std::vector<cv::Point2d> normalised;
    cv::undistortPoints(std::vector<cv::Point2d>{{pixel.x(), pixel.y()}}, normalised, k, d, cv::noArray(),
                        cv::noArray(),
                        cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 60, 1e-12));
    const Eigen::Vector2d p_mm = camera.planeFromPixel(pixel);
    const Eigen::Vector3d in_camera = camera.X_CP * Eigen::Vector3d(p_mm.x(), p_mm.y(), 0.0);
    EXPECT_NEAR(in_camera.x() / in_camera.z(), normalised[0].x, 1e-9);
    EXPECT_NEAR(in_camera.y() / in_camera.z(), normalised[0].y, 1e-9);
  }
}

TEST(CameraCalibration, ProjectsAsOpenCv) {
  const CameraCalibration camera = test::tiltedCamera(1800, 1800, 0.1);
  const cv::Matx33d k(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  const std::vector<double> d(camera.distortion.begin(), camera.distortion.end());
  for (const Eigen::Vector2d& p_mm :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(70, -50), Eigen::Vector2d(-80, 85)}) {
    const Eigen::Vector3d in_camera = camera.X_CP * Eigen::Vector3d(p_mm.x(), p_mm.y(), 0.0);
    std::vector<cv::Point2d> image;
    cv::projectPoints(std::vector<cv::Point3d>{{in_camera.x(), in_camera.y(), in_camera.z()}},
                      cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), k, d, image);
    const Eigen::Vector2d pixel = camera.pixelFromPlane(p_mm);
    EXPECT_NEAR(pixel.x(), image[0].x, 1e-9);
    EXPECT_NEAR(pixel.y(), image[0].y, 1e-9);
  }
}

TEST(CameraCalibration, JacobianIsThatOfFiniteDifferences) {
  const CameraCalibration camera = test::tiltedCamera(1800, 1800, 0.1);
  const Eigen::Vector2d p_mm(47.0, -61.0);
  const LocalPixelMap map = camera.localMap(p_mm);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d h = 1e-4 * Eigen::Vector2d::Unit(i);
    const Eigen::Vector2d slope = (camera.pixelFromPlane(p_mm + h) - camera.pixelFromPlane(p_mm - h)) / 2e-4;
    EXPECT_LT((slope - map.pixel_per_mm.col(i)).norm(), 1e-6);
  }
  EXPECT_LT((map.pixel - camera.pixelFromPlane(p_mm)).norm(), 1e-12);
}

/// A calibration that errs by a mode reads the pixel of p as p + mapError: there OpenCV must see that pixel
/// with a camera that errs in the same way.
TEST(CameraCalibration, AnErrorModeMovesPointsAsACameraThatIsWrongByIt) {
  CameraCalibration camera = test::tiltedCamera(1800, 1800, 0.1);
  for (Eigen::Index parameter = 0; parameter < CameraCalibration::kParameters; ++parameter) {
    // The sizes are in pixels, coefficients of the lens, rad and mm: each moves points by some hundredths of
    // a mm.
    constexpr double kSizes[] = {0.5, 0.5,  0.3,  0.3,  4e-3, 0.1,  1e-4, 1e-4,
                                 2.0, 3e-4, 3e-4, 3e-4, 0.05, 0.05, 0.3};
    camera.error_modes.emplace_back(Eigen::Matrix<double, CameraCalibration::kParameters, 1>::Zero());
    camera.error_modes.back()[parameter] = kSizes[parameter];
  }
  for (std::size_t k = 0; k < camera.error_modes.size(); ++k) {
    const auto& e = camera.error_modes[k];
    const cv::Matx33d matrix(camera.fx_px + e[0], 0, camera.cx_px + e[2], 0, camera.fy_px + e[1],
                             camera.cy_px + e[3], 0, 0, 1);
    std::vector<double> lens(camera.distortion.begin(), camera.distortion.end());
    for (std::size_t i = 0; i < lens.size(); ++i) lens[i] += e[static_cast<Eigen::Index>(4 + i)];
    double largest_mm = 0.0;
    for (const Eigen::Vector2d& p_mm : {Eigen::Vector2d(70, -50), Eigen::Vector2d(-60, 65)}) {
      const Eigen::Vector2d shift_mm = camera.mapError(k, p_mm);
      largest_mm = std::max(largest_mm, shift_mm.norm());
      const Eigen::Vector2d q_mm = p_mm + shift_mm;
      const Eigen::Vector3d q = camera.X_CP.linear() * Eigen::Vector3d(q_mm.x(), q_mm.y(), 0.0);
      const Eigen::Vector3d t = camera.X_CP.translation() + e.tail<3>();
      std::vector<cv::Point2d> image;
      cv::projectPoints(std::vector<cv::Point3d>{{q.x(), q.y(), q.z()}}, cv::Vec3d(e[9], e[10], e[11]),
                        cv::Vec3d(t.x(), t.y(), t.z()), matrix, lens, image);
      const Eigen::Vector2d pixel = camera.pixelFromPlane(p_mm);
      EXPECT_NEAR(image[0].x, pixel.x(), 1e-6) << "parameter " << k;
      EXPECT_NEAR(image[0].y, pixel.y(), 1e-6) << "parameter " << k;
    }
    EXPECT_GT(largest_mm, 0.003) << "parameter " << k;
  }
}

TEST(CameraCalibration, BulkIsTheSameAsOneByOne) {
  const CameraCalibration camera = test::tiltedCamera(1800, 1800, 0.1);
  const std::vector<Eigen::Vector2d> pixels = pixelGrid(camera, 5.0);
  std::vector<Eigen::Vector2d> plane(pixels.size());
  const auto begin = std::chrono::steady_clock::now();
  camera.planeFromPixels(pixels, plane);
  const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
  RecordProperty("ns_per_point", std::to_string(took.count() / static_cast<double>(pixels.size())));
  for (std::size_t i = 0; i < pixels.size(); i += 977) EXPECT_EQ(plane[i], camera.planeFromPixel(pixels[i]));
}

TEST(CameraCalibration, RefusesARayThatMissesThePlane) {
  CameraCalibration camera = test::tiltedCamera(640, 480, 0.1);
  camera.distortion = {};
  camera.fx_px = camera.fy_px = 300.0;
  camera.X_CP.linear() =
      Eigen::AngleAxisd(3.14159265358979 + 1.4, Eigen::Vector3d::UnitX()).toRotationMatrix();
  int missed = 0;
  for (const double row : {0.0, 479.0}) {
    try {
      (void)camera.planeFromPixel({320.0, row});
    } catch (const std::domain_error&) {
      ++missed;
    }
  }
  EXPECT_EQ(missed, 1);
}

TEST(CameraCalibration, DoesNotSeeWhatTheLensPolynomialFoldsBack) {
  const CameraCalibration camera = test::tiltedCamera(1800, 1800, 0.1);
  EXPECT_TRUE(camera.pixelIfSeen({0.0, 0.0}, 0.0));
  EXPECT_FALSE(camera.pixelIfSeen({200.0, 0.0}, 0.0));
  EXPECT_FALSE(camera.pixelIfSeen({1500.0, 0.0}, 0.0));
}

TEST(CameraCalibration, ATelecentricLensAndItsMirrorImageInDepthReadKerfsAlike) {
  // Views of flat targets do not tell the two apart, so neither may they differ below the printed face.
  const auto leaningBy = [](double lean_rad) {
    CameraCalibration camera = test::tiltedCamera(640, 480, 0.03);
    camera.distortion = {};
    camera.telecentric_mm = 300.0;
    camera.X_CP.linear() =
        Eigen::AngleAxisd(std::numbers::pi + lean_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
    return camera;
  };
  const CameraCalibration one = leaningBy(0.009);
  const CameraCalibration other = leaningBy(-0.009);
  for (const double depth_mm : {0.0, 0.3}) {
    for (const Eigen::Vector2d& pixel : pixelGrid(one, 101.3)) {
      const Eigen::Vector2d apart_mm =
          one.lowered(depth_mm).planeFromPixel(pixel) - other.lowered(depth_mm).planeFromPixel(pixel);
      EXPECT_LT(apart_mm.norm(), 1e-9) << depth_mm;
    }
  }
}

TEST(CameraCalibration, PitchIsTheScaleAtTheCentre) {
  EXPECT_NEAR(test::tiltedCamera(1800, 1800, 0.1).pitchMm(), 0.1, 0.001);
}

}  // namespace
}  // namespace kerfbench::vision
