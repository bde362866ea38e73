// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hil/camera/v4l2/v4l2_frames.h"
#include "hil/camera/v4l2/v4l2_stream.h"
#include "twin/base/image.h"

namespace kerfbench::guest {

camera::CameraSettings grey(int width_px, int height_px);
/// Options for this number of frames; a camera without a frame for half a second has stopped.
camera::V4l2FrameOptions optionsFor(std::uint64_t frames);

/// Frames and reports of a source until it ended.
struct Taken {
  std::vector<Frame> frames;
  camera::CaptureReport report;
  [[nodiscard]] std::vector<std::string> incidents() const;
};

/// The bench's path from a device to frames, with the camera's clock taken for the pins'.
class CameraReader {
 public:
  /// Starts the stream. @throws as V4l2Stream.
  CameraReader(const std::string& path, const camera::CameraSettings& settings,
               const camera::V4l2FrameOptions& options);
  /// Takes `count` good frames, or fewer at the end.
  std::vector<Frame> take(std::size_t count) { return source_.nextBatch(count); }
  /// Takes all frames to the end.
  Taken takeAll();

 private:
  camera::V4l2Stream stream_;
  camera::V4l2FrameSource source_;
};

}  // namespace kerfbench::guest
