// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <system_error>

#include "firmware_under_test/planner/job/job.h"
#include "hil/base/atomic_file.h"

namespace kerfbench::planner {

/// Writes a file that a user named, whole or not at all; to standard output if the name is empty or "-". What
/// is no regular file, such as a device or a pipe, is written to. @throws PlanError with the path.
inline void writeOutput(const std::filesystem::path& path, const std::string& text) {
  if (path.empty() || path == "-") {
    std::cout << text;
    return;
  }
  std::error_code unknown;
  if (std::filesystem::exists(path, unknown) && !std::filesystem::is_regular_file(path, unknown)) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    if (!file.flush()) throw PlanError(path.string() + ": cannot be written");
    return;
  }
  try {
    base::writeFileAtomically(path, text);
  } catch (const std::system_error& error) {
    throw PlanError(path.string() + ": cannot be written: " + error.code().message());
  }
}

}  // namespace kerfbench::planner
