// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "hil/base/exit_codes.h"
#include "hil/doctor/child_check.h"
#include "hil/doctor/loopback.h"

namespace kerfbench::app {

/// See doctorCommand().
struct DoctorOptions {
  std::filesystem::path scenario;  ///< Empty: what this computer has, and no more.
  bool json{};
  doctor::LoopbackOptions bench;
  doctor::ChildOptions child;
  std::filesystem::path bin_dir;
};

/// What hardware this computer has and what is wrong with it, on standard output. Returns 0; with a scenario
/// 1 if something that it needs is missing, or base::kExitInput. With `bench` it measures instead: 1 if the
/// loop-back cannot be measured, or loses edges at its lowest rate. With `child` that is tried instead: 1 if
/// it breaks what the pin stream asks of it.
int doctorCommand(const DoctorOptions& options);

}  // namespace kerfbench::app
