// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "hil/camera/v4l2/frame_recorder.h"
#include "hil/camera/v4l2/v4l2_stream.h"
#include "hil/judge/real_spot.h"
#include "hil/scenario/case.h"

namespace kerfbench::live {

/// The spot camera that a case names, set up as it asks for and streaming.
struct OpenSpotCamera {
  std::unique_ptr<camera::V4l2Stream> stream;
  camera::RecordedCamera camera;
};
/// @throws ConfigError for no such camera, or several; InputError with everything that is wrong with it: no
/// permission, a format or a setting that it has not or makes another of. Each with file and line.
OpenSpotCamera openSpotCamera(const scenario::Case& test_case, camera::VideoCalls& calls);

/// Options for the camera of a case: one that a trigger drives may be silent for any time.
camera::RecordOptions recordOptions(const OpenSpotCamera& open);

/// Records the spot camera of a case in the background while something else is going on (pins are captured).
class SpotRecorder {
 public:
  /// Begins. `folder`: see FrameRecordingWriter. @throws as openSpotCamera(), std::system_error.
  SpotRecorder(const scenario::Case& test_case, camera::VideoCalls& calls,
               const std::filesystem::path& folder);
  ~SpotRecorder();
  SpotRecorder(const SpotRecorder&) = delete;
  SpotRecorder& operator=(const SpotRecorder&) = delete;

  /// Ends; returns why the camera ended by itself, or empty. @throws std::system_error if the disk took no
  /// more.
  std::string finish();
  [[nodiscard]] const camera::RecordedCamera& camera() const { return open_.camera; }
  [[nodiscard]] std::uint64_t frames() const { return writer_.frames(); }

 private:
  OpenSpotCamera open_;
  camera::FrameRecordingWriter writer_;
  std::atomic<bool> is_over_{};
  std::string ended_;
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace kerfbench::live
