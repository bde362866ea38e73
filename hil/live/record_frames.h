// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "hil/camera/v4l2/video_calls.h"

namespace kerfbench::live {

/// Options of a recording of the spot camera alone.
struct RecordFramesOptions {
  std::filesystem::path scenario;
  std::filesystem::path out;
  std::uint64_t frames{};     ///< 0: until it ends, by time or by itself.
  double time_limit_s{60.0};  ///< Length of the recording from the first frame on.
  double wait_s{10.0};        ///< Time to wait for the first frame.
  bool quiet{};
  std::filesystem::path bin_dir;
};

/// Records the spot camera that a scenario names by these calls. Returns 0; 3 if fewer frames came than were
/// asked for, or none. @throws ConfigError; InputError, also for a folder that holds anything.
int recordFramesOf(camera::VideoCalls& calls, const RecordFramesOptions& options);

}  // namespace kerfbench::live
