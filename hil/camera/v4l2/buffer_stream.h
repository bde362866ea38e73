// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "hil/camera/v4l2/camera_settings.h"
#include "hil/camera/v4l2/frame_watch.h"

namespace kerfbench::camera {

/// Next event of a camera.
struct StreamEvent {
  enum class Kind {
    kFrame,
    kTimeout,      ///< Nothing came in time; asking again is allowed.
    kSizeChanged,  ///< Size or format are others now: what follows cannot be read as this stream.
    kGone,         ///< The device has vanished.
    kFailed,       ///< The driver broke its contract or reports a failure; see `words`.
    kEnd,          ///< A recording is over.
  };
  Kind kind{Kind::kFrame};
  BufferNote note{};  ///< Note of the driver on a frame.
  std::span<const std::uint8_t>
      bytes{};          ///< Bytes of a frame, in the stream's own memory, until the next call.
  std::string words{};  ///< Description of anything else.
};

/// Buffers of a camera as its driver gives them, live or from a recording.
class BufferStream {
 public:
  virtual ~BufferStream() = default;
  /// Waits at most so long. What ends a stream (anything but kFrame and kTimeout) is given again.
  virtual StreamEvent next(int timeout_ms) = 0;
  [[nodiscard]] virtual const CameraSetup& setup() const = 0;
};

}  // namespace kerfbench::camera
