// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/oblique_view.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace kerfbench::judge {
namespace {

/// A camera 300 mm above (10, -5) of its plane, that looks at the plane turned by `tilt_rad`.
vision::CameraCalibration cameraAbove(double tilt_rad) {
  vision::CameraCalibration calibration;
  const Eigen::AngleAxisd down(std::numbers::pi + tilt_rad, Eigen::Vector3d::UnitX());
  calibration.X_CP.linear() = down.toRotationMatrix();
  calibration.X_CP.translation() = -(calibration.X_CP.linear() * Eigen::Vector3d(10.0, -5.0, 300.0));
  return calibration;
}

vision::KerfScan scanAt(const Eigen::Vector2d& p_V_mm, bool found) {
  vision::EntityKerf kerf;
  vision::Caliper caliper;
  caliper.p_V_mm = p_V_mm;
  caliper.found = found;
  kerf.calipers.push_back(caliper);
  vision::KerfScan scan;
  scan.entities.push_back(kerf);
  return scan;
}

TEST(ObliqueShift, IsHalfTheThicknessTimesTheTangentOfTheAngle) {
  // tan 7.3 degrees is 0.1281: 38.43 mm beside the foot of the camera, whichever way it looks.
  for (const double tilt_rad : {0.0, 0.05}) {
    const vision::CameraCalibration calibration = cameraAbove(tilt_rad);
    EXPECT_NEAR(obliqueShift_mm(scanAt({10.0 + 38.43, -5.0}, true), calibration, 0.4), 0.0256, 1e-4);
    EXPECT_NEAR(obliqueShift_mm(scanAt({10.0, -5.0 - 38.43}, true), calibration, 0.2), 0.0128, 1e-4);
    EXPECT_NEAR(obliqueShift_mm(scanAt({10.0, -5.0}, true), calibration, 0.4), 0.0, 1e-12);
  }
}

TEST(ObliqueShift, CountsKerfsThatWereFound) {
  EXPECT_EQ(obliqueShift_mm(scanAt({80.0, 0.0}, false), cameraAbove(0.0), 0.4), 0.0);
  EXPECT_EQ(obliqueShift_mm({}, cameraAbove(0.0), 0.4), 0.0);
}

}  // namespace
}  // namespace kerfbench::judge
