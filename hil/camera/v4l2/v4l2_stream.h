// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/camera/v4l2/camera_settings.h"
#include "hil/camera/v4l2/frame_watch.h"
#include "hil/camera/v4l2/video_device.h"

namespace kerfbench::hil {

/// What came next from a camera.
struct StreamEvent {
  enum class Kind {
    kFrame,
    kTimeout,      ///< Nothing came in time; asking again is allowed.
    kSizeChanged,  ///< Size or format are others now: what follows cannot be read as this stream.
    kGone,         ///< The device has vanished.
    kFailed,       ///< The driver broke its contract or reports a failure; see `words`.
  };
  Kind kind{Kind::kFrame};
  BufferNote note{};                      ///< Of a frame.
  std::span<const std::uint8_t> bytes{};  ///< Of a frame, in the driver's own memory, until the next call.
  std::string words{};                    ///< Of anything else.
};

/// A camera that streams into buffers that it shares with us (MMAP). Starts when made, stops when destroyed.
class V4l2Stream {
 public:
  /// `calls` must outlive this; `buffers` is asked for, 2 … 32, the driver may give others.
  /// @throws std::invalid_argument with everything wrong about the settings; std::system_error with path and
  /// call.
  V4l2Stream(VideoCalls& calls, const std::string& path, const CameraSettings& settings, int buffers = 8);
  ~V4l2Stream();
  V4l2Stream(const V4l2Stream&) = delete;
  V4l2Stream& operator=(const V4l2Stream&) = delete;

  /// Waits at most so long. After kSizeChanged, kGone and kFailed it gives the same again.
  StreamEvent next(int timeout_ms);
  [[nodiscard]] const CameraSetup& setup() const { return setup_; }

 private:
  struct Mapping {
    void* address{};
    std::size_t length{};
  };
  void requireCapture();
  void subscribe();
  void mapBuffers(int count);
  void releaseAll() noexcept;
  StreamEvent end(StreamEvent::Kind kind, std::string words);
  StreamEvent endBy(int error, const char* call);
  bool giveBack(StreamEvent& ended);
  bool sizeEvent();
  std::optional<StreamEvent> checkLayout();
  std::optional<StreamEvent> take();

  VideoDevice device_;
  CameraSettings settings_;
  CameraSetup setup_;
  std::vector<Mapping> mappings_;
  std::optional<std::uint32_t> held_;  ///< Index of the buffer whose bytes were given out.
  std::optional<StreamEvent> ended_;
};

}  // namespace kerfbench::hil
