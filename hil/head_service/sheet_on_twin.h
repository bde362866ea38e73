// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "hil/head_service/measured_sheet.h"
#include "hil/run/cut_on_twin.h"
#include "hil/run/lockstep.h"
#include "hil/scenario/case.h"
#include "twin/description/fidelity.h"
#include "twin/description/imperfections.h"

namespace kerfbench::head_service {

/// The machine that cuts, and how.
struct TwinBench {
  std::uint64_t seed{1};  ///< Seed by which the machine is sampled.
  twin::Preset imperfections{twin::Preset::kStatic};
  twin::Fidelity fidelity{twin::Fidelity::kFast};
  std::filesystem::path bin_dir;
  std::string firmware{};  ///< Firmware as a scenario names it; empty: that of MarkCutting.
  bool keep_pictures{};    ///< Keeps the pictures in the folder `pictures` next to the job.
  int threads{1};
};

struct SheetRequest {
  calibrate::MarkJob job;
  int sheet{};  ///< Number of the sheet in this calibration; each has pictures with noise of its own.
  std::filesystem::path folder;  ///< Folder for the files of this sheet.
  std::filesystem::path table;   ///< Table that the controller uses; empty: none.
};

/// The scenario that cuts the job with that table, put into the folder with all its files: the job, its
/// drawing, the table, a machine that has it. @throws ConfigError, std::system_error.
scenario::Case sheetCase(const HeadSetup& setup, const TwinBench& bench, const SheetRequest& request);

struct SheetOnTwin {
  MeasuredSheet measured;
  bool was_there{};  ///< Measured by an earlier run.
};

/// Cuts the job with that table and nothing else changed, and measures the pictures. Into the folder go the
/// job, a machine with the table and a scenario that `run` repeats, and last what was measured; that is taken
/// from there if machine, table, job, release, seed and calibration are still the same.
/// @throws HeadEvidenceError for a run or pictures that cannot be trusted, ConfigError, and as cutOnTwin().
SheetOnTwin sheetOnTwin(const HeadSetup& setup, const TwinBench& bench, const SheetRequest& request,
                        const run::ProgressFn& progress);

/// Pictures of a cut sheet; sheets of one calibration have noise of their own by their number.
camera::TwinTileSource sheetPictures(const HeadSetup& setup, const TwinBench& bench,
                                     const scenario::Case& test_case, run::CutSheet& cut, int sheet,
                                     double turn_rad = 0.0);
/// The sheet as cut. @throws HeadEvidenceError for a run that cannot be trusted; as cutOnTwin().
run::CutSheet cutSheet(const scenario::Case& test_case, const TwinBench& bench, const std::string& job,
                       const run::ProgressFn& progress);

/// The files of a sheet in its folder.
inline constexpr const char* kSheetJob = "marks.yaml";
/// Table that the sheet was cut with; no file: none.
inline constexpr const char* kSheetTable = "table.csv";
inline constexpr const char* kSheetMeasured = "measured.yaml";

}  // namespace kerfbench::head_service
