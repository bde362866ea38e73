// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/spot_watch.h"

#include <algorithm>
#include <utility>

#include "hil/judge/pin_wiring.h"
#include "hil/scenario/camera_files.h"

namespace kerfbench::judge {
namespace {

// The camera is recorded while the laser works, and a little before and after: time for a few whole pictures,
// by which the marks are found.
constexpr double kRecordMargin_s = 0.05;
constexpr double kWholePictures = 3.0;

}  // namespace

double recordMargin_s(const twin::CameraDescription& camera) {
  const PixelWindow whole{0, 0, camera.width_px, camera.height_px};
  const double picture_s = std::max(camera.frame_period_s, camera.read_out.time_s({&whole, 1}, camera.bits));
  return std::max(kRecordMargin_s, kWholePictures * picture_s);
}

vision::SpotTrackOptions spotTrackOptions(const scenario::Case& test_case, vision::BeamAim aim, int threads) {
  vision::SpotTrackOptions options{threads, test_case.scenario.belt_speed_mm_s};
  options.aim = std::move(aim);
  options.read_out = test_case.machine.spot_camera.read_out;
  options.frame_period_s = test_case.machine.spot_camera.frame_period_s;
  return options;
}

std::unique_ptr<SpotWatch> SpotWatch::of(const scenario::Case& test_case, camera::MachineCameras& cameras,
                                         TickRate rate, int threads) {
  const scenario::Scenario& scenario = test_case.scenario;
  const std::optional<evidence::ActiveLine> gate = evidence::gateLine(pinWiring(test_case));
  const bool is_stopped = scenario.provoke.cause != scenario::ProvokeChoice::Cause::kNone;
  if (threads < 2 || scenario.cameras.spot.is_real || is_stopped || !gate) return nullptr;
  scenario::BenchCameras calibrated = scenario::readCalibrations(test_case);
  if (!calibrated.spot || !calibrated.kerf) return nullptr;
  std::unique_ptr<camera::FramesMeanwhile> frames = cameras.spotFramesMeanwhile(threads);
  if (!frames) return nullptr;
  return std::unique_ptr<SpotWatch>(
      new SpotWatch(test_case, std::move(frames), std::move(*calibrated.spot), *gate, rate, threads));
}

SpotWatch::SpotWatch(const scenario::Case& test_case, std::unique_ptr<camera::FramesMeanwhile> frames,
                     vision::CameraCalibration calibration, evidence::ActiveLine gate, TickRate rate,
                     int threads)
    : test_case_(test_case),
      frames_(std::move(frames)),
      calibration_(std::move(calibration)),
      // Where the beam was later is not known yet.
      wanted_(gate, rate, recordMargin_s(test_case.machine.spot_camera),
              test_case.machine.spot_camera.exposure_s + evidence::CountedSteps::kKnownAfter_s),
      steps_(stepsFrom(test_case, rate)),
      thread_([this, threads] { measure(threads); }) {}

SpotWatch::~SpotWatch() {
  frames_->close();
  if (thread_.joinable()) thread_.join();
}

void SpotWatch::measure(int threads) {
  try {
    track_ = vision::trackSpot(*frames_, calibration_, test_case_.scenario.print,
                               spotTrackOptions(test_case_, beamAim(test_case_, steps_), threads));
  } catch (...) {
    failure_ = std::current_exception();
    frames_->close();
  }
}

void SpotWatch::heard(Tick until, std::span<const PinEvent> events) {
  if (steps_) steps_->add(events, until);
  wanted_.add(events, until);
  const inspect::Span span = wanted_.soFar();
  frames_->want(span.from_s, span.to_s);
}

vision::SpotTrack SpotWatch::finished() {
  if (steps_) steps_->end();
  if (const auto span = wanted_.inAll()) frames_->want(span->from_s, span->to_s);
  frames_->end();
  thread_.join();
  if (failure_) std::rethrow_exception(failure_);
  return std::move(track_);
}

run::Hearing heardBy(SpotWatch* watch) {
  if (watch == nullptr) return {};
  return [watch](Tick until, std::span<const PinEvent> events) { watch->heard(until, events); };
}

}  // namespace kerfbench::judge
