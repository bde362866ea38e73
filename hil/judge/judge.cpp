// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/judge.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "hil/camera/tile_folder.h"
#include "hil/camera/twin/twin_frames.h"
#include "hil/inspect/inspect.h"
#include "hil/judge/model_parting.h"
#include "hil/judge/pin_stamps.h"
#include "hil/judge/real_spot.h"
#include "hil/run/cut_on_twin.h"
#include "hil/scenario/camera_files.h"
#include "hil/source/encoder_edges.h"
#include "hil/vision/scan/kerf_scan.h"
#include "twin/camera/camera.h"

namespace kerfbench::judge {
namespace {

// The camera is recorded while the laser works, and a little before and after.
constexpr double kRecordMargin_s = 0.05;

// Close enough to see the missing start of a line where the laser comes 2 ms late (0.2 mm at 20 m/s²).
constexpr double kStationPitch_mm = 0.1;

std::vector<twin::Exposure> exposuresWhileLaserWorks(twin::Twin& twin,
                                                     const std::vector<inspect::GateInterval>& gates) {
  std::vector<twin::Exposure> exposures = twin.takeExposures();
  if (gates.empty()) return {};
  const double begin_s = gates.front().on_s - kRecordMargin_s;
  const double end_s = gates.back().off_s + kRecordMargin_s;
  std::erase_if(exposures, [&](const twin::Exposure& e) { return e.start_s < begin_s || e.start_s > end_s; });
  return exposures;
}

std::vector<inspect::GateInterval> gatesOf(const twin::Twin& twin) {
  std::vector<inspect::GateInterval> gates;
  for (const auto& [on_s, off_s] : twin.gateIntervals()) gates.push_back({on_s, off_s});
  return gates;
}

std::vector<inspect::BeltEdge> beltOf(const source::PinRecording& recording, double count_mm) {
  std::vector<inspect::BeltEdge> belt;
  for (const source::EncoderEdge& edge : source::encoderEdges(recording.sensors, recording.rate))
    belt.push_back({edge.time_s, static_cast<double>(edge.counts) * count_mm});
  return belt;
}

void takeRealSpot(RealSpot real, inspect::Evidence& evidence, report::RunReport& report) {
  evidence.spot = std::move(real.track);
  evidence.clock_bound_s = real.clock_bound_s;
  evidence.problems.insert(evidence.problems.end(), real.problems.begin(), real.problems.end());
  report.versions.insert(report.versions.end(), real.facts.begin(), real.facts.end());
}

std::unique_ptr<camera::TileSource> kerfPictures(const scenario::Case& test_case, twin::Twin& twin,
                                                 const vision::CameraCalibration& calibration, int jobs,
                                                 report::RunReport& report) {
  const scenario::CameraChoice& cameras = test_case.scenario.cameras;
  if (!cameras.kerf.tiles.empty()) {
    auto tiles = std::make_unique<camera::TileFolder>(
        cameras.kerf.tiles, camera::PictureSize{calibration.width_px, calibration.height_px});
    report.versions.emplace_back("kerf pictures",
                                 fmt::format("{} of {}, sha256 of their sums {}", tiles->size(),
                                             cameras.kerf.tiles.string(), tiles->sha256OfSums()));
    return tiles;
  }
  if (cameras.spot.is_real)
    report.versions.emplace_back("kerf pictures", "of the model: no real sheet was looked at for the kerf");
  camera::TwinTileOptions options;
  options.threads = jobs;
  return std::make_unique<camera::TwinTileSource>(run::kerfTiles(test_case, twin, options));
}

}  // namespace

void judge(const scenario::Case& test_case, twin::Twin& twin, const run::LockstepResult& run,
           const controller::ControllerReport& words, const RealPictures& pictures, int jobs,
           base::Stopwatch& stopwatch, const run::ProgressFn& progress, report::RunReport& report) {
  const scenario::Scenario& scenario = test_case.scenario;
  const scenario::BenchCameras cameras = scenario::readCalibrations(test_case);

  inspect::Evidence evidence;
  evidence.dieline = &test_case.dieline;
  evidence.print = scenario.print;
  evidence.pulses = twin.pulseTiming();
  evidence.gates = gatesOf(twin);
  evidence.belt_count_mm = test_case.machine.controller.encoder_count_mm;
  evidence.belt = beltOf(run.recording, evidence.belt_count_mm);
  evidence.problems = run.problems;
  evidence.pin_u_s = pinUncertainty_s(run.recording);
  const std::vector<std::string> unproven =
      unprovenSteps(evidence.pulses, run.recording.rate.seconds(run.recording.stamp_err_ticks));
  evidence.problems.insert(evidence.problems.end(), unproven.begin(), unproven.end());
  evidence.account = words.account;
  evidence.end = words.end;
  for (const double edge_s : twin.powerMonitorEdges_s())
    evidence.power_edges_s.push_back(edge_s - test_case.machine.power_monitor.delay_s);
  evidence.power_quantum_j = test_case.machine.power_monitor.quantum_j;
  evidence.problems.insert(evidence.problems.end(), cameras.problems.begin(), cameras.problems.end());
  const bool stopped = evidence.end && inspect::stoppedByItself(*evidence.end, evidence.gates);
  if (evidence.gates.empty() && !stopped)
    evidence.problems.emplace_back("the laser gate was never opened: nothing was cut");

  if (!evidence.gates.empty() && cameras.spot && cameras.kerf) {
    progress(-1, "looking at the spot");
    if (scenario.cameras.spot.is_real) {
      takeRealSpot(
          lookAtRealSpot(test_case, pictures.spot, *cameras.spot, run.recording, evidence.gates, jobs),
          evidence, report);
      stopwatch.lap("spot camera: measure");
    } else {
      camera::TwinFrameSource frames(twin::SpotCamera(test_case.machine.spot_camera, scenario.print,
                                                      test_case.machine.glow_gray_per_w, scenario.seed),
                                     exposuresWhileLaserWorks(twin, evidence.gates), jobs);
      evidence.spot =
          vision::trackSpot(frames, *cameras.spot, scenario.print, {jobs, scenario.belt_speed_mm_s});
      stopwatch.lap("spot camera: render and measure");
    }

    progress(-1, "looking at the cut");
    const std::unique_ptr<camera::TileSource> tiles =
        kerfPictures(test_case, twin, *cameras.kerf, jobs, report);
    vision::KerfScanOptions scan_options;
    scan_options.threads = jobs;
    scan_options.station_pitch_mm = kStationPitch_mm;
    scan_options.beam_radius_mm =
        test_case.machine.beam.waist_radius_mm;  // As the laser's data sheet has it.
    evidence.kerf = scanKerf(*tiles, *cameras.kerf, scenario.print, test_case.dieline, scan_options);
    stopwatch.lap("kerf camera: render and measure");
  }
  evidence.kerf_calibration = cameras.kerf;
  evidence.spot_calibration = cameras.spot;

  report.result = inspect::inspect(evidence, scenario.limits);
  if (scenario.cameras.spot.is_real)
    report.model.partings = spotPartings(evidence.spot, twin.takeExposures(), report.result.cuts);
  report.limits = scenario.limits;
  report.versions.insert(report.versions.end(), cameras.facts.begin(), cameras.facts.end());
  report.dieline = test_case.dieline;
  report.print = scenario.print;
  report.kerf = report.result.edges ? std::move(*report.result.edges) : std::move(evidence.kerf);
  report.result.edges.reset();
  report.spot = std::move(evidence.spot);
  report.pulses = std::move(evidence.pulses);
  stopwatch.lap("inspection");
}

void judgeSafeState(const scenario::Case& test_case, const twin::Twin& twin,
                    inspect::SafeStateEvidence evidence, report::RunReport& report) {
  evidence.pulses = twin.pulseTiming();
  evidence.gates = gatesOf(twin);
  report.provoked = true;
  report.result = inspect::inspectSafeState(evidence);
  report.limits = test_case.scenario.limits;
  report.dieline = test_case.dieline;
  report.print = test_case.scenario.print;
  report.pulses = std::move(evidence.pulses);
}

}  // namespace kerfbench::judge
