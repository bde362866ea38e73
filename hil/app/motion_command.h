// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace kerfbench::app {

struct MotionOptions {
  std::filesystem::path bin_dir;    ///< Folder of the programs.
  std::filesystem::path recording;  ///< pins.vcd of a run, or another recording of a machine's pins.
  std::filesystem::path scenario;   ///< The scenario that was recorded.
  std::filesystem::path out{"motion"};
  double every_s{5e-3};
  bool quiet{};
};

/// Where the pulses of a recording lead the head: table and pictures; nothing is judged. Returns 0.
int motionCommand(const MotionOptions& options);

}  // namespace kerfbench::app
