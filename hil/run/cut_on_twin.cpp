// SPDX-License-Identifier: Apache-2.0
#include "hil/run/cut_on_twin.h"

#include <stdexcept>
#include <utility>
#include <vector>

#include "hil/dieline/geometry.h"
#include "hil/run/dialogs.h"
#include "hil/run/release.h"

namespace kerfbench::run {
namespace {

std::vector<Eigen::AlignedBox2d> boxesOf(const dieline::Dieline& dieline) {
  std::vector<Eigen::AlignedBox2d> boxes;
  for (const dieline::Entity& entity : dieline.entities) {
    if (entity.process == dieline::Process::kIgnore) continue;
    Eigen::AlignedBox2d box;
    for (const double u : dieline::stations(entity.curve, 1.0)) box.extend(dieline::pointAt(entity.curve, u));
    boxes.push_back(box);
  }
  return boxes;
}

template <class Sheet>
camera::TwinTileSource tilesOf(const scenario::Case& test_case, const twin::MachineDescription& machine,
                               Sheet&& sheet, camera::TwinTileOptions options) {
  const scenario::Scenario& scenario = test_case.scenario;
  options.seed = scenario.seed;
  options.table = machine.inspection_table;
  // Board that has grown looks as it did before through a larger scale, on a table that goes less far.
  const double grown = 1.0 + machine.board_lot.swelling;
  twin::CameraDescription camera = machine.kerf_camera;
  camera.fx_px *= grown;
  camera.fy_px *= grown;
  options.table.scale = (1.0 + options.table.scale) / grown - 1.0;
  return {twin::KerfCamera(camera, scenario.print, scenario.seed), std::forward<Sheet>(sheet),
          boxesOf(*test_case.dieline), options};
}

}  // namespace

camera::TwinTileSource kerfTiles(const scenario::Case& test_case, const twin::MachineDescription& machine,
                                 const twin::Sheet& sheet, camera::TwinTileOptions options) {
  return tilesOf(test_case, machine, sheet, options);
}

camera::TwinTileSource kerfTiles(const scenario::Case& test_case, const twin::MachineDescription& machine,
                                 std::shared_ptr<camera::SheetFeed> feed, camera::TwinTileOptions options) {
  return tilesOf(test_case, machine, std::move(feed), options);
}

CutSheet cutOnTwin(const scenario::Case& test_case, const std::filesystem::path& bin_dir,
                   const ProgressFn& progress) {
  const scenario::Scenario& scenario = test_case.scenario;
  if (scenario.provoke.cause != scenario::ProvokeChoice::Cause::kNone)
    throw std::invalid_argument("a case that provokes its release leaves no sheet to look at");
  CutSheet cut;
  cut.sampled = scenario::sampledMachine(test_case);
  const PreparedJob job = prepareJob(test_case);
  cut.summary = job.summary;
  const auto source = openRelease(scenario.firmware, bin_dir);
  cut.machine =
      std::make_unique<ModelMachine>(test_case, cut.sampled, source->info().rate, modelOptions(test_case));
  cut.run = cut.machine->run(*source, job.dialog.get(), lockstepFor(test_case), progress);
  return cut;
}

}  // namespace kerfbench::run
