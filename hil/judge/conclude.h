// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/console.h"
#include "hil/base/stopwatch.h"
#include "hil/controller/controller_report.h"
#include "hil/inspect/safe_state.h"
#include "hil/judge/kerf_watch.h"
#include "hil/judge/run_options.h"
#include "hil/judge/spot_watch.h"
#include "hil/report/run_report.h"
#include "hil/run/lockstep.h"
#include "hil/run/model_machine.h"
#include "hil/scenario/case.h"

namespace kerfbench::judge {

/// Name of the program of a run in its results folder.
inline constexpr const char* kJobFile = "job.gcode";

/// What is concluded from, besides the recording: who ran, what the controller said, and what only people are
/// shown.
struct Conclusion {
  std::string folder_name;  ///< Below the results folder.
  std::string firmware;     ///< For people.
  std::string source_id;
  std::string firmware_sha256;
  std::string
      firmware_version;  ///< As the image says of itself; empty if it is not the reference controller's.
  const twin::SampledMachine* sampled{};  ///< The machine that ran; not null.
  run::ModelMachine* machine{};  ///< After its run: cameras, film, and what the model alone knows; not null.
  SpotWatch* spot_watch{};       ///< Looked at that machine during its run; may be null.
  KerfWatch* kerf_watch{};       ///< Did so as well.
  std::vector<std::string> remarks;  ///< What the firmware said that is no fault, in sentences.
  std::string gcode;                 ///< Written to the results folder unless empty.
  controller::ControllerReport words;
  std::filesystem::path spot_frames;  ///< Recording of a real spot camera; empty: none.
  bool unsealed{};                    ///< A recording without a sum of its own is replayed.
  bool moves_frames{};                ///< True if that recording goes into the results folder.
  /// Writes the trace of the run into the folder of its results, and tells the report of it; empty: there is
  /// none.
  std::function<void(report::RunReport& report, const report::Digests& digests,
                     const std::filesystem::path& folder)>
      finish_trace;
  /// For a run that was to be stopped, without pulses and gates.
  std::optional<inspect::SafeStateEvidence> safe_state;
};
/// From a run, live or replayed, to the verdict: looks, measures, judges, writes the results folder and tells
/// the user. Returns the exit code of the verdict.
int conclude(const scenario::Case& test_case, const run::RecordedRun& run, const Conclusion& conclusion,
             const RunOptions& options, base::Stopwatch& stopwatch, base::Console& console);

/// A case that is not run, since it cannot be judged: the verdict is INVALID for the problems given, with a
/// results folder of its name that has a report and no pins. Returns the exit code of the verdict.
int concludeUnrun(const scenario::Case& test_case, const std::string& folder_name,
                  const std::vector<std::string>& problems, const RunOptions& options,
                  base::Stopwatch& stopwatch, base::Console& console);

}  // namespace kerfbench::judge
