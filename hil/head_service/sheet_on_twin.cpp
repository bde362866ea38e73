// SPDX-License-Identifier: Apache-2.0
#include "hil/head_service/sheet_on_twin.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/version.h"
#include "hil/calibrate/marks/mark_job_file.h"
#include "hil/calibrate/tables/csv_table.h"
#include "hil/camera/tile_folder.h"
#include "hil/head_service/mark_case.h"
#include "hil/run/cut_on_twin.h"

namespace kerfbench::head_service {
namespace {

namespace fs = std::filesystem;

/// The scenario's machine: as it is, or with the table.
fs::path machineWith(const HeadSetup& setup, const SheetRequest& request) {
  if (request.table == setup.table_file) return setup.machine;
  const fs::path file = request.folder / "machine.yaml";
  base::writeFileAtomically(
      file, fmt::format("# SPDX-License-Identifier: Apache-2.0\nextends: '{}'\nname: {}\ncontroller: "
                        "{{correction: '{}'}}\n",
                        setup.machine.string(), setup.name, fs::absolute(request.table).string()));
  return file;
}

/// Table in the folder of the job: what is measured of it later needs to know what the head was aimed at.
void keepTable(const SheetRequest& request) {
  const fs::path kept = request.folder / kSheetTable;
  if (request.table.empty()) {
    fs::remove(kept);
  } else {
    base::writeFileAtomically(kept, calibrate::csvTable(readControllerTable(request.table)));
  }
}

std::string digestOf(const HeadSetup& setup, const TwinBench& bench, const SheetRequest& request,
                     const scenario::Case& test_case) {
  return base::sha256(fmt::format("{} {} {} {} {} {} {} {} {} {}", setup.digest,
                                  calibrate::markJobDigest(request.job),
                                  request.table.empty() ? "-" : base::sha256File(request.table),
                                  base::sha256File(test_case.scenario.firmware.image), bench.seed,
                                  request.sheet, scenario::nameOf(bench.imperfections),
                                  scenario::nameOf(bench.fidelity), base::version(), kMeasuredVersion));
}

void refuseRun(const run::CutSheet& cut, const std::string& job) {
  std::vector<std::string> problems = cut.run.problems;
  if (!cut.run.dialog.reason.empty()) problems.push_back(cut.run.dialog.reason);
  if (!problems.empty()) throw HeadEvidenceError(fmt::format("job {}: {}", job, fmt::join(problems, "\n  ")));
}

camera::TwinTileOptions tileOptions(const HeadSetup& setup, const TwinBench& bench) {
  camera::TwinTileOptions options;
  options.threads = bench.threads;
  options.border_mm = setup.off_mm;
  options.overlap_mm = 0.6 * setup.mark_size_mm;  // A mark's arms are whole in one picture each.
  options.everything = false;
  return options;
}

}  // namespace

scenario::Case sheetCase(const HeadSetup& setup, const TwinBench& bench, const SheetRequest& request) {
  fs::create_directories(request.folder);
  calibrate::writeMarkJob(request.folder / kSheetJob, request.job);
  keepTable(request);
  MarkCutting cutting;
  if (!bench.firmware.empty()) cutting.firmware = bench.firmware;
  cutting.machine = fs::absolute(machineWith(setup, request));
  cutting.beam_radius_mm = setup.beam_radius_mm;
  cutting.imperfections = bench.imperfections;
  cutting.seed = bench.seed;
  cutting.fidelity = bench.fidelity;
  const fs::path scenario = request.folder / "run.yaml";
  base::writeFileAtomically(scenario, markScenario(request.job, "marks.dxf", cutting));
  return scenario::readCase(scenario, bench.bin_dir.parent_path() / "firmware");
}

run::CutSheet cutSheet(const scenario::Case& test_case, const TwinBench& bench, const std::string& job,
                       const run::ProgressFn& progress) {
  run::CutSheet cut = run::cutOnTwin(test_case, bench.bin_dir, progress);
  refuseRun(cut, job);
  return cut;
}

camera::TwinTileSource sheetPictures(const HeadSetup& setup, const TwinBench& bench,
                                     const scenario::Case& test_case, run::CutSheet& cut, int sheet,
                                     double turn_rad) {
  // Seed by the sheet: each lies otherwise on the table, and its pictures have noise of their own.
  scenario::Case camera = test_case;
  camera.scenario.seed = bench.seed + (static_cast<std::uint64_t>(sheet) << 32U);
  camera::TwinTileOptions options = tileOptions(setup, bench);
  options.turn_rad = turn_rad;
  return run::kerfTiles(camera, cut.sampled.machine, cut.machine->sheet(), options);
}

SheetOnTwin sheetOnTwin(const HeadSetup& setup, const TwinBench& bench, const SheetRequest& request,
                        const run::ProgressFn& progress) {
  const scenario::Case test_case = sheetCase(setup, bench, request);
  const std::string digest = digestOf(setup, bench, request, test_case);
  const fs::path result = request.folder / kSheetMeasured;
  if (auto measured = readMeasured(result, calibrate::readMarkJob(request.folder / kSheetJob), digest))
    return {std::move(*measured), true};

  run::CutSheet cut = cutSheet(test_case, bench, request.job.name, progress);
  progress(-1.0, "measuring the marks of " + request.job.name);
  const auto tiles = [&] { return sheetPictures(setup, bench, test_case, cut, request.sheet); };
  if (bench.keep_pictures) {
    auto source = tiles();
    camera::writeTiles(source, request.folder / "pictures");
  }
  auto source = tiles();
  // Job as its file has it, rounded, so that the pictures alone give the same result later.
  SheetOnTwin sheet{
      measureSheet(source, calibrate::readMarkJob(request.folder / kSheetJob), setup, bench.threads), false};
  sheet.measured.digest = digest;
  base::writeFileAtomically(result, measuredText(sheet.measured));
  return sheet;
}

}  // namespace kerfbench::head_service
