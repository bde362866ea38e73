// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/judge.h"

#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hil/base/parallel.h"
#include "hil/camera/tile_folder.h"
#include "hil/diagnose/evidence_json.h"
#include "hil/evidence/pin_evidence.h"
#include "hil/inspect/inspect.h"
#include "hil/judge/beam_aim.h"
#include "hil/judge/diagnosis_evidence.h"
#include "hil/judge/likely_cause.h"
#include "hil/judge/missing_sensors.h"
#include "hil/judge/moments.h"
#include "hil/judge/pin_stamps.h"
#include "hil/judge/pin_wiring.h"
#include "hil/judge/real_spot.h"
#include "hil/scenario/camera_files.h"
#include "hil/vision/scan/kerf_scan.h"

namespace kerfbench::judge {
namespace {

void append(const std::vector<std::string>& problems, inspect::Evidence& evidence) {
  evidence.problems.insert(evidence.problems.end(), problems.begin(), problems.end());
}

/// What the pins and the controller's words show.
inspect::Evidence pinsAndWords(const scenario::Case& test_case, const run::RecordedRun& run,
                               const controller::ControllerReport& words) {
  const evidence::PinWiring wiring = pinWiring(test_case);
  evidence::PinEvidence pins = evidence::pinEvidence(run.recording, wiring);
  inspect::Evidence result;
  result.dieline = test_case.dieline.get();
  result.print = test_case.scenario.print;
  result.pulses = std::move(pins.pulses);
  result.gates = std::move(pins.gates);
  result.light = std::move(pins.light);
  result.guard_open = std::move(pins.guard_open);
  result.belt_count_mm = wiring.encoder_count_mm;
  result.belt = std::move(pins.belt);
  result.pin_u_s = pinUncertainty_s(run.recording);
  result.account = words.account;
  result.end = words.end;
  result.words_expected = test_case.scenario.firmware.dialog == scenario::FirmwareChoice::Dialog::kKerfbench;
  result.no_words = result.words_expected
                        ? "The recording holds nothing that the controller said."
                        : "Only the reference controller reports this (firmware.dialog: kerfbench).";
  result.print_sigma_mm = test_case.scenario.print_sigma_mm;
  result.beam_radius_mm = test_case.machine.beam.waist_radius_mm;  // As the laser's data sheet has it.
  result.power_edges_s = std::move(pins.power_edges_s);
  result.power_quantum_j = test_case.machine.power_monitor.quantum_j;
  append(run.problems, result);
  result.guard_problems = run.guard_problems;
  append(missingSensors(test_case, run.recording, result), result);
  append(unprovenSteps(result.pulses, run.recording.rate.seconds(run.recording.stamp_err_ticks)), result);
  return result;
}

/// One run before the cameras.
class Look {
 public:
  Look(const scenario::Case& test_case, const Cameras& cameras, const Observer& observer,
       inspect::Evidence& evidence)
      : test_case_(test_case), cameras_(cameras), observer_(observer), evidence_(evidence) {}

  /// Both cameras at once, as far as neither is a real one: nothing that one shows is asked by the other.
  void atSpotAndCut(const source::PinRecording& recording, const vision::CameraCalibration& spot,
                    const vision::CameraCalibration& kerf) {
    if (test_case_.scenario.cameras.spot.is_real) {
      observer_.progress(-1, "looking at the spot");
      atRealSpot(recording, spot);
      observer_.stopwatch.lap("spot camera: measure");
      observer_.progress(-1, "looking at the cut");
      atCut(kerf);
      observer_.stopwatch.lap("kerf camera: render and measure");
      return;
    }
    observer_.progress(-1, "looking at spot and cut");
    // What the one does in order leaves the processor to the other.
    base::forEachIndex(2, cameras_.threads,
                       [&](std::size_t camera) { camera == 0 ? atSpot(recording, spot) : atCut(kerf); });
    observer_.stopwatch.lap("spot and kerf camera: render and measure");
  }

  std::vector<std::pair<std::string, std::string>>& facts() { return facts_; }
  std::vector<report::EvidencePart>& pictures() { return pictures_; }

 private:
  void atRealSpot(const source::PinRecording& recording, const vision::CameraCalibration& calibration) {
    RealSpot real =
        lookAtRealSpot(test_case_, cameras_.spot_frames, calibration, recording, evidence_, cameras_.threads);
    evidence_.spot = std::move(real.track);
    evidence_.clock_bound_s = real.clock_bound_s;
    append(real.problems, evidence_);
    pictures_.push_back({"spot frames", real.sha256});
    facts_.insert(facts_.end(), real.facts.begin(), real.facts.end());
  }

  /// What the machine's spot camera shows, as far as it was not looked at during the run.
  void atSpot(const source::PinRecording& recording, const vision::CameraCalibration& calibration) {
    if (cameras_.spot_watch != nullptr) {
      evidence_.spot = cameras_.spot_watch->finished();
      return;
    }
    const double margin_s = recordMargin_s(test_case_.machine.spot_camera);
    const std::unique_ptr<camera::FrameSource> frames = cameras_.of_machine.spotFrames(
        evidence_.gates.front().on_s - margin_s, evidence_.gates.back().off_s + margin_s, cameras_.threads);
    evidence_.spot = vision::trackSpot(
        *frames, calibration, test_case_.scenario.print,
        spotTrackOptions(test_case_, beamAim(test_case_, stepsOf(test_case_, recording)), cameras_.threads));
  }

  /// What the kerf camera shows, as far as it was not looked at during the run.
  void atCut(const vision::CameraCalibration& calibration) {
    if (cameras_.kerf_watch != nullptr) {
      evidence_.kerf = cameras_.kerf_watch->finished();
      return;
    }
    const std::unique_ptr<camera::TileSource> tiles = kerfPictures(calibration);
    evidence_.kerf = scanKerf(*tiles, calibration, test_case_.scenario.print, *test_case_.dieline,
                              kerfScanOptions(test_case_, calibration, cameras_.threads));
  }

  std::unique_ptr<camera::TileSource> kerfPictures(const vision::CameraCalibration& calibration) {
    const scenario::CameraChoice& chosen = test_case_.scenario.cameras;
    if (!chosen.kerf.tiles.empty()) {
      auto tiles = std::make_unique<camera::TileFolder>(
          chosen.kerf.tiles, camera::PictureSize{calibration.width_px, calibration.height_px});
      pictures_.push_back({"kerf pictures", tiles->sha256OfSums()});
      facts_.emplace_back("kerf pictures", fmt::format("{} of {}, sha256 of their sums {}", tiles->size(),
                                                       chosen.kerf.tiles.string(), pictures_.back().sha256));
      return tiles;
    }
    if (chosen.spot.is_real)
      facts_.emplace_back("kerf pictures", "of the model: no real sheet was looked at for the kerf");
    return cameras_.of_machine.kerfTiles(cameras_.threads);
  }

  const scenario::Case& test_case_;
  const Cameras& cameras_;
  const Observer& observer_;
  inspect::Evidence& evidence_;
  std::vector<std::pair<std::string, std::string>> facts_;
  std::vector<report::EvidencePart> pictures_;
};

/// Looks for nothing in a run that has passed.
void findCauses(const scenario::Case& test_case, const source::PinRecording& recording,
                const inspect::Evidence& evidence, bool keeps_evidence, Judgement& judgement) {
  const bool passed = judgement.result.verdict == inspect::Verdict::kPass;
  if (passed && !keeps_evidence) return;
  diagnose::Evidence known = diagnosisEvidence(test_case, recording, evidence, judgement.result);
  if (!passed) {
    PlainCauses plain = plainCauses(test_case, recording, evidence, judgement.result);
    known.gate_polarity = std::move(plain.gate);
    known.axes = std::move(plain.axes);
    known.steady_power = std::move(plain.steady_power);
    known.corners = std::move(plain.corners);
  }
  judgement.diagnosis = diagnose::diagnose(known);
  if (keeps_evidence) judgement.diagnosis_evidence = diagnose::evidenceJson(known);
}

}  // namespace

Judgement judge(const scenario::Case& test_case, const run::RecordedRun& run,
                const controller::ControllerReport& words, const Cameras& cameras, const Observer& observer) {
  const scenario::BenchCameras calibrated = scenario::readCalibrations(test_case);
  inspect::Evidence evidence = pinsAndWords(test_case, run, words);
  append(calibrated.problems, evidence);
  const bool stopped = evidence.end && inspect::stoppedByItself(*evidence.end, evidence.gates);
  if (evidence.gates.empty() && !stopped)
    evidence.problems.emplace_back("the laser gate was never opened: nothing was cut");

  Look look(test_case, cameras, observer, evidence);
  if (!evidence.gates.empty() && calibrated.spot && calibrated.kerf) {
    look.atSpotAndCut(run.recording, *calibrated.spot, *calibrated.kerf);
  }
  evidence.threads = cameras.threads;
  evidence.kerf_calibration = calibrated.kerf;
  evidence.spot_calibration = calibrated.spot;

  Judgement judgement;
  judgement.result = inspect::inspect(evidence, test_case.scenario.limits);
  findCauses(test_case, run.recording, evidence, observer.keeps_evidence, judgement);
  judgement.facts = std::move(look.facts());
  judgement.pictures = std::move(look.pictures());
  judgement.facts.insert(judgement.facts.end(), calibrated.facts.begin(), calibrated.facts.end());
  judgement.kerf = judgement.result.edges ? std::move(*judgement.result.edges) : std::move(evidence.kerf);
  judgement.result.edges.reset();
  judgement.spot = std::move(evidence.spot);
  judgement.pulses = std::move(evidence.pulses);
  observer.stopwatch.lap("inspection");
  return judgement;
}

Judgement judgeSafeState(const scenario::Case& test_case, const run::RecordedRun& run,
                         inspect::SafeStateEvidence evidence) {
  evidence.pin_u_s = pinUncertainty_s(run.recording);
  evidence::PinEvidence pins = evidence::pinEvidence(run.recording, pinWiring(test_case));
  evidence.pulses = std::move(pins.pulses);
  evidence.gates = std::move(pins.gates);
  for (std::string& problem :
       unprovenSteps(evidence.pulses, run.recording.rate.seconds(run.recording.stamp_err_ticks)))
    evidence.problems.push_back(std::move(problem));
  Judgement judgement;
  judgement.result = inspect::inspectSafeState(evidence);
  judgement.safe = safeTimeline(evidence);
  judgement.pulses = std::move(evidence.pulses);
  return judgement;
}

void addJudgement(Judgement judgement, report::RunReport& report) {
  report.result = std::move(judgement.result);
  report.kerf = std::move(judgement.kerf);
  report.spot = std::move(judgement.spot);
  report.pulses = std::move(judgement.pulses);
  report.diagnosis = std::move(judgement.diagnosis);
  report.safe = std::move(judgement.safe);
  report.evidence = std::move(judgement.pictures);
  report.versions.insert(report.versions.end(), judgement.facts.begin(), judgement.facts.end());
}

}  // namespace kerfbench::judge
