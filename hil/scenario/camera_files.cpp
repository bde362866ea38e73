// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/camera_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "hil/base/digest.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/files/calibration_file.h"
#include "hil/calibrate/files/day.h"

namespace kerfbench::scenario {
namespace {

/// Why a calibration is not to be used; empty for a good one.
std::string faultOf(const calibrate::CalibrationFile& file, const machine_file::CameraFile& named,
                    const twin::CameraDescription& camera, const Scenario& scenario) {
  const vision::CameraCalibration& c = file.calibration;
  if (c.camera_id != named.id)
    return fmt::format("is of another camera: '{}', not '{}'", c.camera_id, named.id);
  if (c.width_px != camera.width_px || c.height_px != camera.height_px) {
    return fmt::format("is of another camera: of {} x {} pixels, not {} x {}", c.width_px, c.height_px,
                       camera.width_px, camera.height_px);
  }
  if (file.described_camera != cameraFingerprint(camera))
    return "is stale: the machine file describes another lens or mount than when it was made";
  if (scenario.date.empty()) return {};
  const int age_days =
      calibrate::dayNumber(scenario.date).value_or(0) - calibrate::dayNumber(c.date).value_or(0);
  if (age_days < 0) return fmt::format("is of {}, after the run's date {}", c.date, scenario.date);
  if (age_days > scenario.calibration_max_age_days) {
    return fmt::format("is stale: of {}, {} days before the run's date {}; at most {} are allowed", c.date,
                       age_days, scenario.date, scenario.calibration_max_age_days);
  }
  return {};
}

std::optional<vision::CameraCalibration> readOne(const Case& test_case, const std::string& which,
                                                 const machine_file::CameraFile& named,
                                                 const twin::CameraDescription& camera,
                                                 BenchCameras& cameras) {
  const auto problem = [&](const std::string& fault) {
    cameras.problems.push_back(
        fmt::format("{} camera: its calibration {} {}; to calibrate it, run: ./bench calibrate camera "
                    "--machine {} --camera {} "
                    "--date {}",
                    which, named.calibration.string(), fault, test_case.scenario.machine.string(), which,
                    test_case.scenario.date.empty() ? "DAY" : test_case.scenario.date));
    return std::nullopt;
  };
  if (!std::filesystem::is_regular_file(named.calibration)) return problem("is missing");
  calibrate::CalibrationFile file;
  try {
    file = calibrate::readCalibrationFile(named.calibration);
  } catch (const base::ConfigError& e) {
    std::string faults = e.what();
    std::ranges::replace(faults, '\n', ' ');
    return problem(fmt::format("cannot be used ({})", faults));
  }
  if (const std::string fault = faultOf(file, named, camera, test_case.scenario); !fault.empty())
    return problem(fault);
  const vision::CameraCalibration& c = file.calibration;
  cameras.facts.emplace_back(
      which + " camera",
      fmt::format(
          "{}, calibrated {}, {} corners in {} views, residual {:.4f} px, map {:.2f} um (1 sigma), sha256 {}",
          c.camera_id, c.date, file.corners, file.views, c.rms_px, 1e3 * c.map_u_mm,
          base::sha256File(named.calibration).substr(0, 16)));
  return c;
}

}  // namespace

std::string cameraFingerprint(const twin::CameraDescription& camera) {
  // Nine digits: angles of a mount go through sines, whose last bits differ between libraries.
  std::string text = fmt::format("{} {} {:.9g} {:.9g} {:.9g} {:.9g}", camera.width_px, camera.height_px,
                                 camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px);
  const auto add = [&text](double value) { text += fmt::format(" {:.9f}", value == 0.0 ? 0.0 : value); };
  for (const double k : camera.distortion) add(k);
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (Eigen::Index column = 0; column < 4; ++column) {
      // Rounded first: -1e-17 is no other mount than 0.
      const double value = std::round(camera.X_CP.matrix()(row, column) * 1e9) / 1e9;
      add(value);
    }
  }
  if (camera.telecentric_mm > 0.0) text += fmt::format(" telecentric {:.9g}", camera.telecentric_mm);
  return base::sha256(text).substr(0, 16);
}

BenchCameras readCalibrations(const Case& test_case) {
  BenchCameras cameras;
  cameras.spot = readOne(test_case, "spot", test_case.spot_camera, test_case.machine.spot_camera, cameras);
  cameras.kerf = readOne(test_case, "kerf", test_case.kerf_camera, test_case.machine.kerf_camera, cameras);
  return cameras;
}

}  // namespace kerfbench::scenario
