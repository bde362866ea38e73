// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "hil/base/unique_fd.h"
#include "hil/camera/v4l2/buffer_stream.h"

namespace kerfbench::camera {

/// Camera of a recording.
struct RecordedCamera {
  std::string device;             ///< Path, when it was recorded.
  std::string card, driver, bus;  ///< Names by the driver.
  bool is_triggered{};            ///< See V4l2FrameOptions.
  bool sensor_has_noise{true};    ///< See WatchOptions.
  CameraSetup setup;
};

/// Buffers of a camera as files, byte by byte as the driver gave them, faulty ones included, so that what
/// judges them live judges them again:
///
///     frames.raw    the buffers' bytes, one after the other
///     frames.csv    one line a buffer: see kIndexColumns
///     camera.yaml   camera, format, settings, why it ended, digest of frames.csv; written last, in one step
///
/// Without camera.yaml a recording is unfinished, and is not read.
class FrameRecordingWriter {
 public:
  static constexpr const char* kIndexColumns =
      "sequence,stamp_ns,arrival_ns,clock,start_of_exposure,error,short,bytes,xxh3_128";

  /// Makes the folder. @throws std::system_error; std::invalid_argument if it holds anything.
  FrameRecordingWriter(std::filesystem::path folder, RecordedCamera camera);
  /// Takes an event of kind kFrame. @throws std::system_error if the disk is full, say.
  void add(const StreamEvent& frame);
  /// `ended`: in words, what ended it other than being asked to; empty otherwise. @throws std::system_error.
  void finish(const std::string& ended);
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
  RecordedCamera camera_;
  std::ofstream raw_, index_;
  std::uint64_t frames_{};
};

/// A recording that is given again, as fast as it is asked for. What follows its last frame is what ended it:
/// kEnd, with the words of finish().
class FrameRecording final : public BufferStream {
 public:
  /// @throws ConfigError with everything that is wrong: an unfinished recording, one that was changed since.
  explicit FrameRecording(std::filesystem::path folder);

  StreamEvent next(int timeout_ms) override;
  [[nodiscard]] const CameraSetup& setup() const override { return camera_.setup; }
  [[nodiscard]] const RecordedCamera& camera() const { return camera_; }
  [[nodiscard]] std::size_t frames() const { return entries_.size(); }
  /// Reason why fewer frames came than were wanted, or empty.
  [[nodiscard]] const std::string& ended() const { return ended_; }
  /// Digest of all that the recording is.
  [[nodiscard]] const std::string& digest() const { return digest_; }

 private:
  struct Entry {
    BufferNote note;
    std::uint64_t at{};
    std::uint64_t bytes{};
    std::string digest;
  };
  void readCamera();
  void readIndex(const std::string& text);
  [[nodiscard]] StreamEvent failed(const char* what) const;

  std::filesystem::path folder_;
  RecordedCamera camera_;
  std::string ended_, digest_, index_digest_;
  std::uint64_t promised_{};
  std::vector<Entry> entries_;
  base::UniqueFd raw_;
  std::vector<std::uint8_t> buffer_;
  std::size_t next_{};
};

}  // namespace kerfbench::camera
