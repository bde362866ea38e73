// SPDX-License-Identifier: Apache-2.0
#include "tests/guest/camera_reader.h"

#include <utility>

#include "twin/base/image.h"

namespace kerfbench::guest {

camera::CameraSettings grey(int width_px, int height_px) {
  camera::CameraSettings settings;
  settings.format = camera::findPixelFormat("GREY");
  settings.width_px = width_px;
  settings.height_px = height_px;
  return settings;
}

camera::V4l2FrameOptions optionsFor(std::uint64_t frames) {
  camera::V4l2FrameOptions options;
  options.exposure_s = 1e-3;
  options.frames = frames;
  options.timeout_ms = 500;
  return options;
}

std::vector<std::string> Taken::incidents() const {
  std::vector<std::string> words;
  for (const camera::CaptureIncident& incident : report.first_incidents) words.push_back(incident.words);
  return words;
}

CameraReader::CameraReader(const std::string& path, const camera::CameraSettings& settings,
                           const camera::V4l2FrameOptions& options)
    : stream_(camera::kernelVideoCalls(), path, settings),
      source_(stream_, camera::CameraClock(0.0, {{0.0, 0.0}}), options) {}

Taken CameraReader::takeAll() {
  std::vector<Frame> frames = source_.nextBatch(SIZE_MAX);
  return {std::move(frames), source_.report()};
}

}  // namespace kerfbench::guest
