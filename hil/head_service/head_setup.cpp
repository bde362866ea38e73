// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/head_setup.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <set>

#include "hil/base/digest.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/marks/mark_job.h"
#include "hil/calibrate/marks/mark_pattern.h"
#include "hil/calibrate/tables/table_files.h"
#include "hil/scenario/camera_files.h"
#include "hil/scenario/case.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;

constexpr double kFieldStep_mm = 5.0;
constexpr double kOff_mm = 4.0, kOffShare = 0.03;  // 7 mm of 100, 13 of 300: a head as it is mounted

vision::CameraCalibration kerfCamera(const fs::path& machine, const machine_file::MachineFile& file) {
  scenario::Case test_case;
  test_case.scenario.machine = machine;
  test_case.machine = file.machine;
  test_case.spot_camera = file.spot_camera;
  test_case.kerf_camera = file.kerf_camera;
  const scenario::BenchCameras cameras = scenario::readCalibrations(test_case);
  if (!cameras.kerf) throw HeadEvidenceError(fmt::format("{}", fmt::join(cameras.problems, "\n")));
  return *cameras.kerf;
}

/// Digest of every file that gives a key, wherever they lie.
std::string digestOf(const machine_file::MachineFile& file, const std::vector<fs::path>& others) {
  std::set<std::string> paths;
  for (const auto& [key, place] : file.places) paths.insert(place.substr(0, place.rfind(':')));
  std::set<std::string> digests;
  for (const std::string& path : paths) digests.insert(base::sha256File(path));
  std::string all;
  for (const std::string& digest : digests) all += digest;
  for (const fs::path& path : others) all += path.empty() ? "-" : base::sha256File(path);
  return base::sha256(all);
}

void setOptics(const twin::MachineDescription& machine, HeadSetup& setup) {
  const twin::ControllerDescription& told = machine.controller;
  setup.nominal = {.throw_mm = told.throw_mm,
                   .mirror_spacing_mm = told.mirror_spacing_mm,
                   .focal_length_mm = told.focal_length_mm,
                   .mirror_step_rad = told.mirror_step_rad};
  const bool lens = told.focal_length_mm > 0.0;
  setup.design = {.throw_mm = lens ? machine.head.throw_mm : told.throw_mm,
                  .mirror_spacing_mm = lens ? machine.head.mirror_spacing_mm : told.mirror_spacing_mm,
                  .y_mirror_first = machine.head.y_mirror_first,
                  .lens = {}};
  if (lens) setup.design.lens = calibrate::LensDesign{.focal_length_mm = told.focal_length_mm};
  setup.beam_radius_mm = machine.beam.waist_radius_mm;
  setup.open_gray = machine.kerf_camera.open_gray;
}

/// The size of marks, and the part of the controller's field that holds them whole.
void setField(const twin::ControllerDescription& told, int densest, HeadSetup& setup) {
  setup.controller_W_mm = {Eigen::Vector2d(told.field_min_mm[0], told.field_min_mm[1]),
                           Eigen::Vector2d(told.field_max_mm[0], told.field_max_mm[1])};
  const auto inner = [&](double reach_mm) {
    const Eigen::Array2d low = (setup.controller_W_mm.min().array() + reach_mm) / kFieldStep_mm;
    const Eigen::Array2d high = (setup.controller_W_mm.max().array() - reach_mm) / kFieldStep_mm;
    return Eigen::AlignedBox2d((kFieldStep_mm * low.ceil()).matrix(),
                               (kFieldStep_mm * high.floor()).matrix());
  };
  const auto size = [&](const Eigen::AlignedBox2d& field) {
    if (field.isEmpty()) throw std::invalid_argument("the controller's field holds no mark");
    return calibrate::markSizeFor(field.sizes().minCoeff() / (densest - 1), 2.0 * setup.beam_radius_mm);
  };
  const double most_mm = size(setup.controller_W_mm);
  setup.field_W_mm = inner(0.5 * calibrate::kMarkReach * most_mm);
  setup.mark_size_mm = size(setup.field_W_mm);
  setup.off_mm = kOff_mm + kOffShare * setup.field_W_mm.sizes().maxCoeff();
}

}  // namespace

calibrate::AimGrid readControllerTable(const fs::path& path) {
  try {
    return calibrate::readTable(path, {}, calibrate::TableFormat::kCsv);
  } catch (const calibrate::TableFileError& error) {
    throw base::ConfigError(error.what());
  }
}

HeadSetup readHeadSetup(const fs::path& machine, int densest, const fs::path& table_file) {
  const machine_file::MachineFile file = machine_file::readMachineFile(machine);
  if (file.machine.kind != twin::MachineDescription::Kind::kTwoMirror)
    throw base::ConfigError(fmt::format("{}: a gantry has no scan head to calibrate", machine.string()));
  HeadSetup setup;
  setup.machine = fs::absolute(machine).lexically_normal();
  setup.name = file.machine.name;
  setOptics(file.machine, setup);
  try {
    setField(file.machine.controller, densest, setup);
    calibrate::check(setup.nominal);
    calibrate::check(setup.design);
  } catch (const std::invalid_argument& error) {
    throw base::ConfigError(fmt::format("{}: {}", machine.string(), error.what()));
  }
  setup.table_file = table_file.empty() ? fs::path(file.machine.controller.correction_file) : table_file;
  if (!setup.table_file.empty()) setup.table = readControllerTable(setup.table_file);
  setup.camera = kerfCamera(machine, file);
  setup.table_sigma_mm = file.kerf_camera.table_sigma_mm;
  setup.digest = digestOf(file, {file.kerf_camera.calibration, setup.table_file});
  return setup;
}

}  // namespace kerfbench::head_service
