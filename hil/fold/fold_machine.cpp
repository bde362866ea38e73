// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/fold_machine.h"

#include <cmath>
#include <set>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "hil/calibrate/files/calibration_file.h"
#include "hil/fold/fold_units.h"
#include "hil/machine_file/machine_file.h"

namespace kerfbench::fold {
namespace {

using Eigen::Vector3d;

constexpr double kMicro = 1e-6;
constexpr std::size_t kMostCameras = 16;

/// Pose of W in a camera at a place that looks at a point, its picture upright in W.
Eigen::Isometry3d lookingAt(const Vector3d& place_mm, const Vector3d& target_mm) {
  const Vector3d forward = (target_mm - place_mm).normalized();
  // Straight down there is no upright; the picture's x is then W's.
  const Vector3d right = forward.cross(Vector3d::UnitZ()).norm() > 1e-6
                             ? Vector3d(forward.cross(Vector3d::UnitZ()).normalized())
                             : Vector3d(Vector3d::UnitX());
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  X_WC.linear() << right, forward.cross(right), forward;
  X_WC.translation() = place_mm;
  return X_WC.inverse();
}

SurveyCamera readSurveyCamera(base::YamlReader& section) {
  SurveyCamera result;
  result.id = section.text("id");
  const Vector3d place_mm = vectorOf(section.numbers("place_mm", 3, {.min = -1e4, .max = 1e4}));
  const Vector3d target_mm = vectorOf(section.numbers("look_at_mm", 3, {.min = -1e4, .max = 1e4}));
  const auto size = section.numbers("size_px", 2, {.min = 64, .max = 8192});
  const double pitch_mm = section.number("pitch_mm", {.min = 1e-3, .max = 10});
  const double away_mm = (place_mm - target_mm).norm();
  if (!(away_mm >= 10.0)) section.fault("look_at_mm", "is nearer than 10 mm to place_mm");
  twin::CameraDescription& camera = result.camera;
  camera.width_px = static_cast<int>(std::lround(size[0]));
  camera.height_px = static_cast<int>(std::lround(size[1]));
  camera.fx_px = camera.fy_px = std::max(away_mm, 10.0) / pitch_mm;
  camera.cx_px = 0.5 * (camera.width_px - 1);
  camera.cy_px = 0.5 * (camera.height_px - 1);
  camera.X_CP = lookingAt(place_mm, target_mm);
  camera.psf_sigma_px = section.number("psf_sigma_px", {.min = 0, .max = 2, .fallback = 0.7});
  camera.read_noise = section.number("read_noise_gray", {.min = 0, .max = 50, .fallback = 0.8});
  camera.board_gray = section.number("board_gray", {.min = 20, .max = 250, .fallback = 130.0});
  base::YamlReader certificate = section.section("calibration");
  result.certificate.turn_rad = kMicro * certificate.number("turn_urad", {.min = 0.1, .max = 1000});
  result.certificate.shift_mm = kMicron_mm * certificate.number("shift_um", {.min = 0.01, .max = 1000});
  result.certificate.focal_share = kMicro * certificate.number("focal_ppm", {.min = 0.1, .max = 1000});
  result.certificate.principal_px = certificate.number("principal_px", {.min = 1e-3, .max = 10});
  return result;
}

std::vector<SurveyCamera> readSurvey(base::YamlReader& file) {
  std::vector<SurveyCamera> cameras;
  std::set<std::string> ids;
  for (base::YamlReader& section : file.list("survey")) {
    cameras.push_back(readSurveyCamera(section));
    if (!ids.insert(cameras.back().id).second) section.fault("id", "is that of another camera");
  }
  if (cameras.empty() || cameras.size() > kMostCameras)
    file.fault("survey", fmt::format("must list 1 … {} cameras", kMostCameras));
  return cameras;
}

FoldKerfCamera readKerfCamera(const std::filesystem::path& machine,
                              std::vector<std::filesystem::path>& inputs) {
  const machine_file::MachineFile file = machine_file::readMachineFile(machine);
  FoldKerfCamera kerf;
  kerf.camera = file.machine.kerf_camera;
  kerf.table.step_mm = file.kerf_camera.table_sigma_mm;
  kerf.calibration = calibrate::readCalibrationFile(file.kerf_camera.calibration).calibration;
  kerf.table_sigma_mm = std::hypot(file.kerf_camera.table_sigma_mm, file.kerf_camera.table_straightness_mm);
  kerf.table_scale_sigma = file.kerf_camera.table_scale_sigma;
  kerf.scale_sigma = file.kerf_camera.target_scale_sigma;
  kerf.open_gray_sigma = file.kerf_camera.open_gray_sigma;
  inputs.insert(inputs.end(), file.inputs.begin(), file.inputs.end());
  return kerf;
}

void readHead(base::YamlReader& file, FoldMachine& machine) {
  base::YamlReader axes = file.section("axes");
  twin::FiveAxisDescription& head = machine.head;
  head.pivot_mm = axes.number("pivot_mm", {.min = 1, .max = 2000});
  head.linear_step_mm = axes.number("linear_step_mm", {.min = 1e-6, .max = 1});
  head.turn_step_rad = kDegree * axes.number("turn_step_deg", {.min = 1e-6, .max = 5});
  head.feed_mm_s = axes.number("feed_mm_s", {.min = 0.1, .max = 1e4});
  head.turn_speed_rad_s = kDegree * axes.number("turn_speed_deg_s", {.min = 1, .max = 5000});
  base::YamlReader laser = file.section("laser");
  head.power_w = laser.number("power_w", {.min = 0.01, .max = 1e5});
  head.power_follows_speed = laser.boolean("power_follows_speed", true);
  base::YamlReader beam = file.section("beam");
  head.waist_radius_mm = beam.number("waist_radius_mm", {.min = 0.031, .max = 2});
  machine.beam_radius_sigma = 0.01 * beam.number("radius_percent", {.min = 0.1, .max = 50, .fallback = 5.0});
  head.rayleigh_mm = beam.number("rayleigh_mm", {.min = 0.1, .max = 1e4});
  head.errors = readErrors(file.section("errors"), {});
}

}  // namespace

twin::FiveAxisErrors readErrors(base::YamlReader section, const twin::FiveAxisErrors& known) {
  constexpr double kMost_deg = 5.0;
  const auto degrees = [&](const char* key, double known_rad, bool both_ways) {
    return kDegree *
           section.number(
               key, {.min = both_ways ? -kMost_deg : 0.0, .max = kMost_deg, .fallback = known_rad / kDegree});
  };
  twin::FiveAxisErrors errors;
  errors.pivot_mm = section.number("pivot_mm", {.min = -5, .max = 5, .fallback = known.pivot_mm});
  errors.a_zero_rad = degrees("a_zero_deg", known.a_zero_rad, true);
  errors.c_zero_rad = degrees("c_zero_deg", known.c_zero_rad, true);
  errors.a_backlash_rad = degrees("a_backlash_deg", known.a_backlash_rad, false);
  errors.c_backlash_rad = degrees("c_backlash_deg", known.c_backlash_rad, false);
  errors.squareness_rad = degrees("squareness_deg", known.squareness_rad, true);
  return errors;
}

FoldMachine readFoldMachine(const std::filesystem::path& path) {
  base::YamlReader file = base::YamlReader::openFile(path);
  FoldMachine machine;
  file.integer("version", {.min = 1, .max = 1});
  machine.name = file.text("name");
  file.choice("kind", {"five-axis"});
  readHead(file, machine);
  machine.survey = readSurvey(file);
  const std::filesystem::path inspection = file.folderOf("inspection") / file.text("inspection");
  file.finish();
  machine.keys = file.asked();
  machine.inputs = file.inputs();
  machine.kerf = readKerfCamera(inspection, machine.inputs);
  return machine;
}

}  // namespace kerfbench::fold
