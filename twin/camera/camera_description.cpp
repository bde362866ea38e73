// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "twin/camera/camera.h"

namespace kerfbench::twin {

std::string faultsOf(const CameraDescription& camera) {
  std::string faults;
  const auto require = [&faults](bool fine, const char* rule) {
    if (!fine) faults += (faults.empty() ? "camera: " : "; ") + std::string(rule);
  };
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  const auto notNegative = [](double value) { return std::isfinite(value) && value >= 0.0; };
  require(camera.width_px >= 16 && camera.width_px <= 32768, "width_px must be in [16, 32768]");
  require(camera.height_px >= 16 && camera.height_px <= 32768, "height_px must be in [16, 32768]");
  require(positive(camera.fx_px), "fx_px must be > 0");
  require(positive(camera.fy_px), "fy_px must be > 0");
  require(std::isfinite(camera.cx_px) && std::isfinite(camera.cy_px), "cx_px and cy_px must be finite");
  for (const double k : camera.distortion) require(std::isfinite(k), "distortion must be finite");
  require(camera.X_CP.matrix().allFinite(), "X_CP must be finite");
  const Eigen::Matrix3d R_CP = camera.X_CP.linear();
  require((R_CP.transpose() * R_CP - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 1e-6,
          "X_CP must be a rotation and a shift");
  require(notNegative(camera.psf_sigma_px) && camera.psf_sigma_px <= 10.0, "psf_sigma_px must be in [0, 10]");
  require(notNegative(camera.read_noise), "read_noise must be >= 0");
  require(camera.full_well_electrons > 0.0, "full_well_electrons must be > 0");
  require(notNegative(camera.board_gray) && camera.board_gray <= 255.0, "board_gray must be in [0, 255]");
  return faults;
}

std::string faultsOf(const PrintLayout& print) {
  std::string faults;
  const auto require = [&faults](bool fine, const char* rule) {
    if (!fine) faults += (faults.empty() ? "print: " : "; ") + std::string(rule);
  };
  require(print.units >= 1, "units must be >= 1");
  require(
      std::isfinite(print.pitch_mm) && (print.pitch_mm > 0.0 || (print.units == 1 && print.pitch_mm == 0.0)),
      "pitch_mm must be > 0");
  for (const RegistrationMark& mark : print.marks) {
    require(mark.p_SM_mm.allFinite(), "marks must be at finite places");
    require(std::isfinite(mark.diameter_mm) && mark.diameter_mm > 0.0, "diameter_mm of a mark must be > 0");
  }
  return faults;
}

}  // namespace kerfbench::twin
