// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "hil/camera/v4l2/buffer_stream.h"
#include "hil/camera/v4l2/frame_recording.h"

namespace kerfbench::camera {

struct RecordOptions {
  int timeout_ms{1000};         ///< Time without a frame after which the camera has stopped; > 0.
  int first_timeout_ms{1000};   ///< Time to wait for the first frame; > 0.
  std::uint64_t discard{1};     ///< Frames at the start that are not recorded; see V4l2FrameOptions.
  std::uint64_t most_frames{};  ///< Most frames to record; 0: no limit.
};

/// Writes what a camera gives until `stop` says so (asked at least every 50 ms), until most_frames are there,
/// or until the stream ends, and finishes the recording. Faulty frames are written as they are: judging comes
/// later. Returns why the stream ended by itself, or empty. @throws std::system_error if the disk takes no
/// more: the recording stays unfinished.
std::string recordFrames(BufferStream& stream, FrameRecordingWriter& writer, const RecordOptions& options,
                         const std::function<bool()>& stop);

}  // namespace kerfbench::camera
