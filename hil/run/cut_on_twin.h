// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "hil/camera/twin/twin_tiles.h"
#include "hil/run/lockstep.h"
#include "hil/run/model_machine.h"
#include "hil/scenario/case.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::run {

/// Pictures of all that the case's dieline has on the sheet, by the kerf camera on the inspection table of
/// `machine`, the case's own as described or as sampled. `options` but for seed and table. `sheet` must
/// outlive it.
camera::TwinTileSource kerfTiles(const scenario::Case& test_case, const twin::MachineDescription& machine,
                                 const twin::Sheet& sheet, camera::TwinTileOptions options);
/// The same of a web that still runs.
camera::TwinTileSource kerfTiles(const scenario::Case& test_case, const twin::MachineDescription& machine,
                                 std::shared_ptr<camera::SheetFeed> feed, camera::TwinTileOptions options);

/// A sheet that a release has cut on the twin.
struct CutSheet {
  /// The truth: for reports and tests, never for a measurement.
  twin::SampledMachine sampled;
  std::unique_ptr<ModelMachine> machine;
  std::string summary;  ///< Summary of the job as planned, one line.
  RecordedRun run;
};

/// Plans the case, runs its release on the machine that its seed draws, and judges nothing: the sheet is what
/// is asked for. A case that provokes is not run. @throws as readCase(), prepareJob() and openRelease() do;
/// std::invalid_argument for a case that provokes.
CutSheet cutOnTwin(const scenario::Case& test_case, const std::filesystem::path& bin_dir,
                   const ProgressFn& progress);

}  // namespace kerfbench::run
