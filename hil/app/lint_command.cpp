// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "hil/app/camera_files.h"
#include "hil/app/case.h"
#include "hil/app/commands.h"
#include "hil/app/machine_check.h"
#include "hil/base/yaml_reader.h"
#include "hil/calibrate/calibration_file.h"
#include "hil/calibrate/target_files.h"
#include "hil/dieline/read.h"

namespace kerfbench::hil {
namespace {

namespace fs = std::filesystem;

void say(const std::string& line) { std::fputs((line + "\n").c_str(), stdout); }

bool isDrawing(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? char(c + 32) : c; });
  return extension == ".dxf" || extension == ".svg";
}

// A scenario names a dieline; a machine does not. What it extends counts as well.
bool isScenario(const fs::path& path) {
  const auto file = YamlReader::openFile(path);
  return file.has("dieline") || file.has("firmware");
}

// Returns the number of errors.
int lintDrawing(const fs::path& path, const LayerProfile& layers, bool quiet) {
  const Dieline dieline = readDieline(path, layers);
  int errors = 0;
  for (const LintFinding& finding : lintDieline(dieline)) {
    errors += finding.is_error ? 1 : 0;
    if (quiet && !finding.is_error) continue;
    say(fmt::format("{}: {} at ({:.3f}, {:.3f}) mm, layer {}: {}", path.string(),
                    finding.is_error ? "error" : "warning", finding.p_mm.x(), finding.p_mm.y(),
                    finding.layer.empty() ? "-" : finding.layer, finding.message));
  }
  if (!quiet) {
    const auto box = dieline.bounds();
    if (!box.isEmpty()) {
      say(fmt::format("{}: {} entities, {:.2f} x {:.2f} mm", path.string(), dieline.entities.size(),
                      box.sizes().x(), box.sizes().y()));
    }
  }
  return errors;
}

// A machine can be described before its cameras are calibrated; a run of it would be INVALID.
void warnOfCameras(const fs::path& path, Case& the_case, const MachineFile& file, bool quiet) {
  the_case.machine = file.machine;
  the_case.spot_camera = file.spot_camera;
  the_case.kerf_camera = file.kerf_camera;
  if (quiet) return;
  for (const std::string& problem : readCalibrations(the_case).problems)
    say(fmt::format("{}: warning: {}", path.string(), problem));
}

int lintFile(const fs::path& path, const CommonOptions& options) {
  if (isDrawing(path)) return lintDrawing(path, defaultLayerProfile(), options.quiet);
  const auto file_keys = YamlReader::openFile(path);
  if (file_keys.has("camera_id")) {
    (void)readCalibrationFile(path);
    return 0;
  }
  if (file_keys.has("square_mm")) {
    (void)readTarget(path);
    return 0;
  }
  Case the_case;
  if (isScenario(path)) {
    the_case.scenario = readScenario(path, {options.bin_dir.parent_path() / "firmware"});
    const MachineFile file = readMachineFile(the_case.scenario.machine);
    warnOfCameras(path, the_case, file, options.quiet);
    refuseUnwired(the_case);
    refuseUnfit(file, webOf(the_case));
    return lintDrawing(the_case.scenario.dieline, the_case.scenario.layers, options.quiet);
  }
  const MachineFile file = readMachineFile(path);
  the_case.scenario.machine = path;
  warnOfCameras(path, the_case, file, options.quiet);
  refuseUnfit(file);
  return 0;
}

}  // namespace

int lintCommand(const std::vector<fs::path>& files, const CommonOptions& options) {
  int errors = 0;
  for (const fs::path& path : files) {
    try {
      const int found = lintFile(path, options);
      if (found == 0 && !options.quiet) say(fmt::format("{}: good", path.string()));
      errors += found;
    } catch (const ConfigError& e) {
      std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
      ++errors;
    } catch (const DielineError& e) {
      std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
      ++errors;
    }
  }
  return errors == 0 ? 0 : kExitInput;
}

}  // namespace kerfbench::hil
