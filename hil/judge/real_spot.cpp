// SPDX-License-Identifier: Apache-2.0
#include "hil/judge/real_spot.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include <fmt/format.h>

#include "hil/base/parallel.h"
#include "hil/camera/v4l2/frame_recording.h"
#include "hil/camera/v4l2/light_clock.h"
#include "hil/camera/v4l2/v4l2_frames.h"
#include "hil/judge/pin_wiring.h"
#include "hil/vision/spot/light_seen.h"
#include "twin/base/image.h"
#include "twin/base/statistics.h"

namespace kerfbench::judge {
namespace {

// As of the model's frames: while the laser works, and a little before and after.
constexpr double kMargin_s = 0.05;
constexpr std::size_t kBatch = 16;
constexpr std::size_t kToldIncidents = 5;

camera::V4l2FrameOptions frameOptions(const camera::FrameRecording& recording,
                                      const scenario::SpotCameraChoice& choice) {
  camera::V4l2FrameOptions options;
  options.exposure_s = choice.lit_s;
  options.frames = recording.frames();
  options.discard = 0;  // Not recorded.
  options.is_triggered = recording.camera().is_triggered;
  options.watch.sensor_has_noise = recording.camera().sensor_has_noise;
  return options;
}

/// All frames of a recording as one thing: light in them, and what the driver's word on them is worth.
struct Survey {
  std::vector<camera::FrameLight> lights;
  double period_s{};
  camera::CaptureReport report;
};

Survey surveyOf(const std::filesystem::path& folder, const scenario::SpotCameraChoice& choice, int jobs) {
  camera::FrameRecording recording(folder);
  // Stamps as they are.
  camera::V4l2FrameSource source(recording, camera::CameraClock(0.0, {{0.0, 0.0}}),
                                 frameOptions(recording, choice));
  Survey survey;
  std::vector<double> periods_s;
  std::optional<std::uint64_t> last;
  for (auto frames = source.nextBatch(kBatch); !frames.empty(); frames = source.nextBatch(kBatch)) {
    std::vector<double> light(frames.size());
    base::forEachIndex(frames.size(), jobs,
                       [&](std::size_t i) { light[i] = vision::spotLight(frames[i].image); });
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (last && frames[i].sequence > *last)
        periods_s.push_back((frames[i].start_s - survey.lights.back().stamp_s) /
                            static_cast<double>(frames[i].sequence - *last));
      last = frames[i].sequence;
      survey.lights.push_back({frames[i].start_s, light[i]});
    }
  }
  if (!periods_s.empty()) survey.period_s = upperMedianIn(periods_s);
  survey.report = source.report();
  return survey;
}

/// Frames that begin within a time.
class FramesWithin final : public camera::FrameSource {
 public:
  FramesWithin(camera::FrameSource& all, double from_s, double to_s)
      : all_(all), from_s_(from_s), to_s_(to_s) {}
  std::vector<Frame> nextBatch(std::size_t max) override {
    for (;;) {
      std::vector<Frame> frames = all_.nextBatch(max);
      if (frames.empty()) return frames;
      std::erase_if(frames, [&](const Frame& f) { return f.start_s < from_s_ || f.start_s > to_s_; });
      if (!frames.empty()) return frames;
    }
  }

 private:
  camera::FrameSource& all_;
  double from_s_, to_s_;
};

camera::CameraClockOptions clockOptions(const scenario::SpotCameraChoice& choice, const SignalMap& map) {
  camera::CameraClockOptions options;
  options.exposure_s = choice.lit_s;
  options.stamp_jitter_s = choice.stamp_jitter_s;
  options.edge_error_s = choice.light_error_s;
  options.max_drift = 200e-6;  // Two crystals.
  options.is_light_hard = !map.pin(Signal::kLaserPwm);
  options.max_uncertainty_s = choice.max_clock_s;
  return options;
}

/// When the laser may shine. Without a PWM line a gate may be chopped by its own, and each of its pulses is
/// one.
std::vector<camera::LightInterval> lightIntervals(const inspect::Evidence& laser, const SignalMap& map) {
  std::vector<camera::LightInterval> lights;
  if (map.pin(Signal::kLaserPwm)) {
    for (const inspect::GateInterval& gate : laser.gates) lights.push_back({gate.on_s, gate.off_s});
  } else {
    for (const inspect::Span& pulse : laser.light) lights.push_back({pulse.from_s, pulse.to_s});
  }
  return lights;
}

/// Incidents that touch a cut.
void tellIncidents(const camera::CaptureReport& report, const camera::CameraClock& clock, double period_s,
                   const std::vector<inspect::GateInterval>& gates, std::vector<std::string>& problems) {
  std::size_t told = 0;
  std::size_t all = 0;
  for (const camera::CaptureIncident& incident : report.first_incidents) {
    const double from_s = clock.beginOf_s(incident.from_s) - period_s;
    const double to_s = clock.beginOf_s(incident.to_s) + period_s;
    const auto meets = [&](const inspect::GateInterval& gate) {
      return gate.on_s < to_s && gate.off_s > from_s;
    };
    if (std::ranges::none_of(gates, meets)) continue;
    ++all;
    if (told++ < kToldIncidents)
      problems.push_back(fmt::format("spot camera, frame {} at {:.3f} s, during a cut: {}", incident.sequence,
                                     clock.beginOf_s(incident.to_s), incident.words));
  }
  if (all > kToldIncidents)
    problems.push_back(fmt::format("spot camera: {} more of such frames", all - kToldIncidents));
  if (report.incidents > report.first_incidents.size())
    problems.push_back(fmt::format(
        "spot camera: {} frames lost or not to be believed, too many to look at each", report.incidents));
}

std::string cameraFact(const camera::FrameRecording& recording, const Survey& survey) {
  const camera::RecordedCamera& camera = recording.camera();
  const camera::FrameLayout& layout = camera.setup.layout;
  return fmt::format("{} ({}, {}, {}), {} {} x {}, {} frames, {} good, {} lost; recording sha256 {}",
                     camera.device, camera.card, camera.driver, camera.bus, layout.format->name,
                     layout.width_px, layout.height_px, survey.report.taken, survey.report.good,
                     survey.report.lost, recording.digest().substr(0, 16));
}

std::string clockFact(const camera::CameraClock& clock, double stamp_s) {
  return fmt::format(
      "begin of exposure = stamp {:+.6f} s on the clock of the pins, within {:.3f} ms, by the laser's gate",
      clock.beginOf_s(stamp_s) - stamp_s, 1e3 * clock.uncertaintyAt_s(stamp_s));
}

/// Gate and PWM together.
camera::LightProfile profileOf(const source::PinRecording& pins, const evidence::PinWiring& wiring) {
  std::vector<camera::LightProfile::Step> steps;
  std::optional<evidence::ActiveLine> gate = evidence::gateLine(wiring);
  std::optional<evidence::ActiveLine> pwm = evidence::pwmLine(wiring);
  for (const PinEvent& event : pins.outputs) {
    if (gate) gate->take(event);
    if (pwm) pwm->take(event);
    const bool is_on = (!gate || gate->isActive()) && (!pwm || pwm->isActive());
    if (steps.empty() ? is_on : steps.back().is_on != is_on)
      steps.push_back({pins.rate.seconds(event.tick), is_on});
  }
  return camera::LightProfile(steps);
}

}  // namespace

RealSpot lookAtRealSpot(const scenario::Case& test_case, const std::filesystem::path& folder,
                        const vision::CameraCalibration& calibration, const source::PinRecording& pins,
                        const inspect::Evidence& laser, int jobs) {
  const std::vector<inspect::GateInterval>& gates = laser.gates;
  const scenario::Scenario& scenario = test_case.scenario;
  const scenario::SpotCameraChoice& choice = scenario.cameras.spot;
  RealSpot spot;
  camera::FrameRecording recording(folder);
  spot.sha256 = recording.digest();
  const camera::FrameLayout& layout = recording.camera().setup.layout;
  const PixelWindow taken{layout.left_px, layout.top_px, layout.width_px, layout.height_px};
  const PixelWindow asked =
      choice.settings.window.value_or(PixelWindow{0, 0, calibration.width_px, calibration.height_px});
  if (taken != asked) {
    spot.problems.push_back(fmt::format(
        "the spot camera's frames are {} x {} pixels from ({}, {}) on; {} {} x {} from ({}, {}) on",
        taken.width, taken.height, taken.left, taken.top,
        choice.settings.window ? "the scenario's window is" : "its calibration is for", asked.width,
        asked.height, asked.left, asked.top));
    return spot;
  }
  if (recording.frames() == 0) {
    spot.problems.push_back("the spot camera gave no frame: " + recording.ended());
    return spot;
  }
  const Survey survey = surveyOf(folder, choice, jobs);
  spot.facts.emplace_back("spot frames", cameraFact(recording, survey));
  if (!survey.report.ended_early.empty()) {
    spot.problems.push_back("the recording of the spot camera's frames is damaged: " +
                            survey.report.ended_early);
    return spot;
  }
  const camera::LightProfile profile = profileOf(pins, pinWiring(test_case));
  const camera::CameraClockFit fit =
      camera::fitLightClock(survey.lights, lightIntervals(laser, test_case.machine.signals), &profile,
                            survey.period_s, clockOptions(choice, test_case.machine.signals));
  if (!fit.clock) {
    spot.problems.push_back("the spot camera's clock cannot be related to that of the pins: " + fit.why_not);
    for (const camera::CaptureIncident& incident : survey.report.first_incidents) {
      if (spot.problems.size() > kToldIncidents) break;
      spot.problems.push_back(fmt::format("spot camera, frame {}: {}", incident.sequence, incident.words));
    }
    if (!recording.ended().empty()) spot.problems.push_back("the spot camera: " + recording.ended());
    return spot;
  }
  const double last_s = survey.lights.back().stamp_s;
  const double first_s = std::ranges::find_if(survey.lights, &camera::FrameLight::isLit)->stamp_s;
  for (const camera::FrameLight& light : survey.lights) {
    if (light.isLit())
      spot.clock_bound_s = std::max(spot.clock_bound_s, fit.clock->uncertaintyAt_s(light.stamp_s));
  }
  spot.facts.emplace_back("spot camera's clock", clockFact(*fit.clock, first_s));
  tellIncidents(survey.report, *fit.clock, survey.period_s, gates, spot.problems);
  if (!recording.ended().empty() && fit.clock->beginOf_s(last_s) < gates.back().off_s)
    spot.problems.push_back("the spot camera ended before the last cut: " + recording.ended());
  camera::V4l2FrameSource frames(recording, *fit.clock, frameOptions(recording, choice));
  FramesWithin working(frames, gates.front().on_s - kMargin_s, gates.back().off_s + kMargin_s);
  vision::SpotTrackOptions options{jobs, scenario.belt_speed_mm_s};
  options.window = choice.settings.window;
  spot.track = vision::trackSpot(working, calibration, scenario.print, options);
  return spot;
}

}  // namespace kerfbench::judge
