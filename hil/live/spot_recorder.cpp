// SPDX-License-Identifier: Apache-2.0
#include "hil/live/spot_recorder.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "hil/run/release.h"

namespace kerfbench::live {
namespace {

constexpr int kBuffers = 32;  // As many as V4L2 allows: the disk may stall.

camera::CameraSettings settingsOf(const scenario::Case& test_case) {
  camera::CameraSettings settings = test_case.scenario.cameras.spot.settings;
  settings.width_px = test_case.machine.spot_camera.width_px;
  settings.height_px = test_case.machine.spot_camera.height_px;
  return settings;
}

}  // namespace

OpenSpotCamera openSpotCamera(const scenario::Case& test_case, camera::VideoCalls& calls) {
  const scenario::SpotCameraChoice& choice = test_case.scenario.cameras.spot;
  const std::vector<camera::CameraListing> cameras = camera::listCameras(calls);
  OpenSpotCamera open;
  std::string path;
  try {
    path = scenario::findCamera(choice, cameras);
    open.stream = std::make_unique<camera::V4l2Stream>(calls, path, settingsOf(test_case), kBuffers);
  } catch (const camera::CameraSettingsError& error) {
    throw base::InputError(scenario::faultsOf(choice, error.faults()));
  } catch (const std::system_error& error) {
    throw base::InputError(fmt::format("{}: {}: {}", choice.place, path, camera::problemOf(error)));
  } catch (const std::invalid_argument& error) {
    throw base::InputError(fmt::format("{}: {}", choice.place, error.what()));
  }
  if (const std::string faults = scenario::faultsOf(choice, open.stream->setup()); !faults.empty())
    throw base::InputError(faults);
  const auto listed = std::ranges::find(cameras, path, &camera::CameraListing::path);
  if (listed != cameras.end()) open.camera = {path, listed->card, listed->driver, listed->bus, {}, true, {}};
  open.camera.device = path;
  open.camera.is_triggered = choice.is_triggered;
  open.camera.sensor_has_noise = choice.sensor_has_noise;
  open.camera.setup = open.stream->setup();
  return open;
}

camera::RecordOptions recordOptions(const OpenSpotCamera& open) {
  constexpr double kPeriods = 5.0;
  camera::RecordOptions options;
  // The first buffer of a loopback that runs by itself may hold an old picture; that of a trigger is the
  // first of the job, and may be the only one.
  options.discard = open.camera.is_triggered ? 0 : 1;
  if (open.camera.is_triggered) {
    options.timeout_ms = std::numeric_limits<int>::max();
  } else if (const auto period_s = open.camera.setup.frame_period_s) {
    options.timeout_ms =
        std::max(options.timeout_ms, static_cast<int>(1e3 * kPeriods * std::min(*period_s, 1e4)));
  }
  options.first_timeout_ms = options.timeout_ms;
  return options;
}

SpotRecorder::SpotRecorder(const scenario::Case& test_case, camera::VideoCalls& calls,
                           const std::filesystem::path& folder)
    : open_(openSpotCamera(test_case, calls)), writer_(folder, open_.camera) {
  thread_ = std::thread([this] {
    try {
      ended_ = camera::recordFrames(*open_.stream, writer_, recordOptions(open_),
                                    [this] { return is_over_.load(); });
    } catch (...) {
      failure_ = std::current_exception();
    }
  });
}

SpotRecorder::~SpotRecorder() {
  is_over_ = true;
  if (thread_.joinable()) thread_.join();
}

std::string SpotRecorder::finish() {
  is_over_ = true;
  if (thread_.joinable()) thread_.join();
  if (failure_) std::rethrow_exception(failure_);
  return ended_;
}

}  // namespace kerfbench::live
