// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/files/calibration_file.h"

#include <cmath>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <Eigen/LU>

#include "hil/base/yaml_reader.h"
#include "hil/calibrate/files/day.h"

namespace kerfbench::calibrate {
namespace {

constexpr double kHuge = 1e12;

/// Twelve digits: a thousandth of a nanometre of the map, and no rounding of another machine's library.
std::string list(std::span<const double> values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{:.12g}", text.empty() ? "" : ", ", value);
  return "[" + text + "]";
}

template <typename Vector>
std::string listOf(const Vector& vector) {
  return list({vector.data(), static_cast<std::size_t>(vector.size())});
}

void readLens(base::YamlReader& file, vision::CameraCalibration& c) {
  const auto size = file.numbers("size_px", 2, {.min = 16, .max = 65536});
  if (size[0] != std::floor(size[0]) || size[1] != std::floor(size[1]))
    file.fault("size_px", "must be two whole numbers");
  c.width_px = static_cast<int>(size[0]);
  c.height_px = static_cast<int>(size[1]);
  const auto focal = file.numbers("focal_px", 2, {.min = 1, .max = 1e9});
  c.fx_px = focal[0];
  c.fy_px = focal[1];
  const auto principal = file.numbers("principal_px", 2, {.min = -1e9, .max = 1e9});
  c.cx_px = principal[0];
  c.cy_px = principal[1];
  const auto distortion = file.numbers("distortion", 5, {.min = -1e6, .max = 1e6});
  for (std::size_t i = 0; i < 5; ++i) c.distortion.at(i) = distortion[i];
  if (!file.has("telecentric_mm")) return;
  c.telecentric_mm = file.number("telecentric_mm", {.min = 1, .max = 1e5});
  c.square_within_rad = file.number("square_within_rad", {.min = 0, .max = 1.5});
}

void readPlane(base::YamlReader plane, vision::CameraCalibration& c) {
  Eigen::Vector3d turn;
  const auto rotation = plane.numbers("rotation_vector_rad", 3, {.min = -4, .max = 4});
  for (Eigen::Index i = 0; i < 3; ++i) turn[i] = rotation[static_cast<std::size_t>(i)];
  if (turn.norm() > 0.0)
    c.X_CP.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  const auto translation = plane.numbers("translation_mm", 3, {.min = -1e6, .max = 1e6});
  for (Eigen::Index i = 0; i < 3; ++i) c.X_CP.translation()[i] = translation[static_cast<std::size_t>(i)];
}

}  // namespace

std::string calibrationText(const CalibrationFile& file, const std::string& made_by) {
  const vision::CameraCalibration& c = file.calibration;
  const Eigen::AngleAxisd turn(c.X_CP.linear());
  const Eigen::Vector3d rotation = turn.angle() * turn.axis();
  const Eigen::Vector3d translation = c.X_CP.translation();
  const std::string telecentric =
      c.telecentric_mm > 0.0
          ? fmt::format(
                "telecentric_mm: {:.12g}   # Stands for the distance.\nsquare_within_rad: {:.6g}   # 95 %.\n",
                c.telecentric_mm, c.square_within_rad)
          : "";
  std::string text = fmt::format(
      "# SPDX-License-Identifier: Apache-2.0\n"
      "# Calibration of a camera from images: docs/how-to/calibrate-a-camera.md. Made by\n"
      "#   {}\n"
      "version: 1\n"
      "camera_id: '{}'\n"
      "date: {}\n"
      "described_camera: '{}'   # Fingerprint of the machine file's description.\n"
      "size_px: [{}, {}]\n"
      "focal_px: {}\n"
      "principal_px: {}\n"
      "distortion: {}   # k1 k2 p1 p2 k3\n"
      "{}"
      "plane:   # Pose of the plane in the camera.\n"
      "  rotation_vector_rad: {}\n"
      "  translation_mm: {}\n"
      "views: {}\n"
      "corners: {}\n"
      "rms_px: {:.6g}\n"
      "map_u_mm: {:.6g}   # Largest standard uncertainty of a mapped point within the area.\n"
      "area_min_mm: {}\n"
      "area_max_mm: {}\n"
      "# Covariance as columns L_k, the sum of L_k L_k^T: fx fy cx cy, k1 k2 p1 p2 k3, turn (rad), shift "
      "(mm).\n"
      "error_modes:\n",
      made_by, c.camera_id, c.date, file.described_camera, c.width_px, c.height_px,
      list(std::array{c.fx_px, c.fy_px}), list(std::array{c.cx_px, c.cy_px}), list(c.distortion), telecentric,
      listOf(rotation), listOf(translation), file.views, file.corners, c.rms_px, c.map_u_mm,
      listOf(Eigen::Vector2d(c.area_mm.min())), listOf(Eigen::Vector2d(c.area_mm.max())));
  // Modes that compensate each other's parameters need all their digits as well.
  for (const auto& mode : c.error_modes) text += fmt::format("  - parameters: {}\n", listOf(mode));
  return text;
}

CalibrationFile readCalibrationFile(const std::filesystem::path& path) {
  auto file = base::YamlReader::openFile(path);
  CalibrationFile result;
  vision::CameraCalibration& c = result.calibration;
  if (file.integer("version", {.min = 1, .max = 1e6}) != 1)
    file.fault("version", "this program reads version 1");
  c.camera_id = file.text("camera_id");
  c.date = file.text("date");
  if (!dayNumber(c.date)) file.fault("date", "is no day like 2026-11-21");
  result.described_camera = file.text("described_camera");
  readLens(file, c);
  readPlane(file.section("plane"), c);
  result.views = static_cast<std::size_t>(file.integer("views", {.min = 1, .max = 1e6}));
  result.corners = static_cast<std::size_t>(file.integer("corners", {.min = 1, .max = 1e9}));
  c.rms_px = file.number("rms_px", {.min = 0, .max = 10});
  c.map_u_mm = file.number("map_u_mm", {.min = 1e-9, .max = 10});
  const auto least = file.numbers("area_min_mm", 2, {.min = -1e6, .max = 1e6});
  const auto most = file.numbers("area_max_mm", 2, {.min = -1e6, .max = 1e6});
  c.area_mm = {Eigen::Vector2d(least[0], least[1]), Eigen::Vector2d(most[0], most[1])};
  if (c.area_mm.isEmpty()) file.fault("area_max_mm", "must lie above area_min_mm");
  auto modes = file.list("error_modes");
  if (modes.empty() || modes.size() > vision::CameraCalibration::kParameters)
    file.fault("error_modes", fmt::format("must be 1 … {} of them", vision::CameraCalibration::kParameters));
  for (base::YamlReader& mode : modes) {
    const auto values =
        mode.numbers("parameters", vision::CameraCalibration::kParameters, {.min = -kHuge, .max = kHuge});
    c.error_modes.emplace_back(Eigen::Map<const Eigen::Matrix<double, 15, 1>>(values.data()));
  }
  file.finish();
  return result;
}

}  // namespace kerfbench::calibrate
