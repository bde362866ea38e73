// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hil/base/stopwatch.h"
#include "hil/camera/machine_cameras.h"
#include "hil/controller/controller_report.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/inspect/safe_state.h"
#include "hil/judge/kerf_watch.h"
#include "hil/judge/spot_watch.h"
#include "hil/report/run_report.h"
#include "hil/run/lockstep.h"
#include "hil/scenario/case.h"

namespace kerfbench::judge {

/// What looks at the cut.
struct Cameras {
  camera::MachineCameras& of_machine;
  /// Recording of a real spot camera's frames, which then are looked at instead; empty: none.
  std::filesystem::path spot_frames;
  /// The verdict is the same at any number. Spot and cut take so many each while both are looked at.
  int threads{1};
  /// The look at the machine's spot camera that went on during the run; null: it is looked at now.
  SpotWatch* spot_watch{};
  /// The same of its kerf camera.
  KerfWatch* kerf_watch{};
};

/// Who is told how far it is.
struct Observer {
  base::Stopwatch& stopwatch;
  run::ProgressFn progress;
  /// True: the evidence of the diagnosis is kept, also of a run that passes.
  bool keeps_evidence{};
};

/// What pictures and pins show of a run, and what follows from it.
struct Judgement {
  inspect::InspectionResult result;
  vision::KerfScan kerf;
  vision::SpotTrack spot;
  std::vector<PulseTiming> pulses;
  /// Why the cut is bad; nothing is judged by it.
  diagnose::Diagnosis diagnosis;
  std::optional<report::SafeTimeline> safe;  ///< Only of a run that was to be stopped.
  std::string diagnosis_evidence;            ///< As evidenceJson(), where it is kept.
  /// For the report: which pictures were looked at, with which calibrations.
  std::vector<std::pair<std::string, std::string>> facts;
  std::vector<report::EvidencePart> pictures;  ///< Sums of what real cameras took.
};

/// Judges a run by its recording, its pictures and what the controller said. No model takes part: pulses,
/// gates, belt and power meter are read from the pins, path and stillness from the pictures.
Judgement judge(const scenario::Case& test_case, const run::RecordedRun& run,
                const controller::ControllerReport& words, const Cameras& cameras, const Observer& observer);

/// Judges a run that was to be stopped, by its pins and the controller's words alone; no camera looks.
/// `evidence` lacks pulses and gates, which are read from the recording.
Judgement judgeSafeState(const scenario::Case& test_case, const run::RecordedRun& run,
                         inspect::SafeStateEvidence evidence);

/// Into the measured part of a report; what is there is replaced, facts are added to its versions.
void addJudgement(Judgement judgement, report::RunReport& report);

}  // namespace kerfbench::judge
