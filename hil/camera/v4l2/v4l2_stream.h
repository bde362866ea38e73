// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hil/camera/v4l2/buffer_stream.h"
#include "hil/camera/v4l2/camera_settings.h"
#include "hil/camera/v4l2/video_device.h"

namespace kerfbench::camera {

/// A camera that streams into buffers that it shares with us (MMAP). Starts when made, stops when destroyed.
class V4l2Stream final : public BufferStream {
 public:
  /// `calls` must outlive this; `buffers` is asked for, 2 … 32, the driver may give others.
  /// @throws std::invalid_argument with everything wrong about the settings; std::system_error with path and
  /// call.
  V4l2Stream(VideoCalls& calls, const std::string& path, const CameraSettings& settings, int buffers = 8);
  ~V4l2Stream() override;
  V4l2Stream(const V4l2Stream&) = delete;
  V4l2Stream& operator=(const V4l2Stream&) = delete;

  StreamEvent next(int timeout_ms) override;
  [[nodiscard]] const CameraSetup& setup() const override { return setup_; }

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

}  // namespace kerfbench::camera
