// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/machine_file/machine_sections.h"
#include "twin/cutter/machine_model.h"

namespace kerfbench::machine_file {
namespace {

// The cameras of the model take no other.
constexpr double kMinSide_px = 16;
constexpr double kMaxSide_px = 32768;

// An exposure is put together from whole steps of the machine and must end before the next one begins.
void checkExposure(base::YamlReader& camera, const twin::CameraDescription& description) {
  const double steps = description.exposure_s / twin::MachineModel::kStep_s;
  if (std::abs(steps - std::round(steps)) > 1e-6) {
    camera.fault("exposure_us", fmt::format("must be a multiple of {:g}, the machine's step",
                                            1e6 * twin::MachineModel::kStep_s));
  }
  if (description.exposure_s > description.frame_period_s) {
    camera.fault("exposure_us", "is longer than the time from frame to frame");
  }
}

// A sensor of 2048 rows at 180 frames/s (ams CMV4000, 16 outputs), on a link of 10 Gbit/s.
ReadOut readReadOut(base::YamlReader read_out) {
  ReadOut result;
  result.row_s = 1e-6 * read_out.number("row_us", {.min = 0, .max = 1000, .fallback = 2.7});
  result.link_bytes_per_s = 1e6 * read_out.number("link_mb_per_s", {.min = 0, .max = 1e6, .fallback = 1100});
  return result;
}

}  // namespace

twin::CameraDescription readCamera(base::YamlReader& camera, bool timed) {
  twin::CameraDescription result;
  auto size = camera.numbers("size_px", 2);
  for (double& side_px : size) {
    if (side_px == std::floor(side_px) && side_px >= kMinSide_px && side_px <= kMaxSide_px) continue;
    camera.fault("size_px",
                 fmt::format("{} is no whole number of {} … {}", side_px, kMinSide_px, kMaxSide_px));
    side_px = kMinSide_px;
  }
  result.width_px = static_cast<int>(size[0]);
  result.height_px = static_cast<int>(size[1]);
  const double pitch_mm = camera.number("pitch_mm", {.min = 1e-3, .max = 10});
  const double height_mm = camera.number("height_mm", {.min = 10, .max = 1e4});
  const auto centre_mm = camera.numbers("centre_mm", 2, {.min = -1e4, .max = 1e4, .fallback = 0.0});
  const double tilt_rad =
      std::numbers::pi / 180.0 * camera.number("tilt_deg", {.min = -30, .max = 30, .fallback = 0.0});
  const std::string lens = camera.text("lens", "entocentric");
  if (lens == "telecentric") {
    result.telecentric_mm = height_mm;
  } else if (lens != "entocentric") {
    camera.fault("lens", fmt::format("'{}' is none of entocentric, telecentric", lens));
  }
  const auto distortion = camera.numbers("distortion", 5, {.min = -10, .max = 10, .fallback = 0.0});
  std::ranges::copy(distortion, result.distortion.begin());
  result.fx_px = result.fy_px = height_mm / pitch_mm;
  result.cx_px = 0.5 * (size[0] - 1);
  result.cy_px = 0.5 * (size[1] - 1);
  // Above the point it looks at, image x along +x of the plane, image y along -y, tilted about the camera's
  // own x.
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const Eigen::Matrix3d tilt = Eigen::AngleAxisd(tilt_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
  result.X_CP.linear() = tilt * down;
  result.X_CP.translation() = Eigen::Vector3d(0, 0, height_mm) -
                              result.X_CP.linear() * Eigen::Vector3d(centre_mm[0], centre_mm[1], 0.0);
  result.psf_sigma_px = camera.number("psf_sigma_px", {.min = 0, .max = 2, .fallback = 0.6});
  result.read_noise = camera.number("read_noise_gray", {.min = 0, .max = 50, .fallback = 0.8});
  result.full_well_electrons =
      camera.number("full_well_electrons", {.min = 100, .max = 1e7, .fallback = 1e4});
  if (timed) {
    result.board_gray = camera.number("board_gray", {.min = 0, .max = 250, .fallback = 110.0});
    result.frame_period_s = 1.0 / camera.number("frames_per_s", {.min = 1, .max = 20000});
    result.exposure_s = 1e-6 * camera.number("exposure_us", {.min = 10, .max = 1e5});
    checkExposure(camera, result);
    result.read_out = readReadOut(camera.section("read_out"));
  } else {
    result.open_gray = camera.number("open_gray", {.min = 50, .max = 250, .fallback = twin::kOpenKerfGray});
    result.back_light_half_angle_rad =
        std::numbers::pi / 180.0 *
        camera.number("back_light_half_angle_deg", {.min = 0, .max = 80, .fallback = 0.0});
  }
  readCameraFlaws(camera, timed, result);
  return result;
}

}  // namespace kerfbench::machine_file
