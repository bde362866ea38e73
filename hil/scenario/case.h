// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "hil/dieline/read.h"
#include "hil/machine_file/machine_file.h"
#include "hil/scenario/scenario.h"
#include "twin/description/description.h"
#include "twin/description/imperfections.h"

namespace kerfbench::scenario {

/// A scenario with all files that it names, read and checked.
struct Case {
  Scenario scenario;
  twin::MachineDescription machine;  ///< Machine as described; sampledMachine() is the one that runs.
  twin::ImperfectionSpread spread;
  machine_file::CameraFile spot_camera,
      kerf_camera;                 ///< Cameras as the bench knows them: id and calibration.
  double beam_radius_sigma{0.05};  ///< MachineFile::beam_radius_sigma
  /// All files on which the run depends: those of the scenario and of the machine, each once.
  std::vector<std::filesystem::path> inputs;
  std::shared_ptr<const dieline::Dieline> dieline{dieline::emptyDieline()};  ///< Never null.
  /// Words for the report: a second reader agrees on the drawing, with figures. Empty: none was asked.
  std::string witness{};
};

/// @throws ConfigError or DielineError with everything wrong in the first file that is bad; ConfigError as
/// well for a machine that the twin cannot run, and for a dieline that is unfit to cut (see lintDieline).
/// `progress` is told of a drawing that takes long.
Case readCase(const std::filesystem::path& scenario, const ImagePath& images,
              const base::ProgressFn& progress = {});
/// The same of a scenario that is read already, and good.
Case caseOf(Scenario scenario, const base::ProgressFn& progress = {});
/// With the release that the scenario names.
inline Case readCase(const std::filesystem::path& scenario, const std::filesystem::path& firmware_dir) {
  return readCase(scenario, ImagePath{firmware_dir});
}

/// @throws ConfigError for a scenario that asks of its machine what that has not: a pin, a feed, on real pins
/// the lines.
void refuseUnwired(const Case& test_case);

/// True where what is not selected counts for inside and outside, so that all of the drawing must be fit.
bool needsWholeDrawing(const Scenario& scenario);

/// The machine that runs: around its description, as far as the scenario's preset and seed take it.
/// @throws ConfigError if the seed gives a machine that the twin cannot run.
twin::SampledMachine sampledMachine(const Case& test_case);

/// Machine as the planner is configured with it.
planner::MachineParameters plannerMachine(const Case& test_case);
/// The same with the controller that the scenario's release says it is; a release that does not say gets a
/// job for the AVR release: what it answers must agree with that.
/// @throws planner::PlanError for an image that cannot be read.
planner::MachineParameters targetedMachine(const Case& test_case);
/// Job as the planner is configured with it, the web's start included.
planner::JobParameters plannerJob(const Case& test_case);
/// Web that runs through the machine, of board as its data sheet has it.
twin::WebDescription webOf(const Case& test_case);
/// The same of the lot that lies on `machine`.
twin::WebDescription webOn(const twin::MachineDescription& machine, const Case& test_case);

}  // namespace kerfbench::scenario
