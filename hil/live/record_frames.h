// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "hil/camera/v4l2/video_calls.h"

namespace kerfbench::live {

/// How the spot camera is recorded by itself.
struct RecordFramesOptions {
  std::filesystem::path scenario;
  std::filesystem::path out;
  std::uint64_t frames{};     ///< 0: until it ends, by time or by itself.
  double time_limit_s{60.0};  ///< From the first frame on.
  double wait_s{10.0};        ///< For the first frame.
  bool quiet{};
  std::filesystem::path bin_dir;
};

/// Records the spot camera that a scenario names by these calls. Returns 0; 3 if fewer frames came than were
/// asked for, or none. @throws ConfigError; InputError, also for a folder that holds anything.
int recordFramesOf(camera::VideoCalls& calls, const RecordFramesOptions& options);

}  // namespace kerfbench::live
