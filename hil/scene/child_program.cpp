// SPDX-License-Identifier: Apache-2.0
#include "hil/scene/child_program.h"

#include <unistd.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <system_error>

namespace kerfbench::scene {
namespace {

namespace fs = std::filesystem;

bool executable(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

std::optional<fs::path> findProgram(const fs::path& program) {
  if (program.has_parent_path()) {
    return executable(program) ? std::optional(fs::absolute(program)) : std::nullopt;
  }
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (!folder.empty() && executable(fs::path(folder) / program)) return fs::path(folder) / program;
  }
  return std::nullopt;
}

}  // namespace kerfbench::scene
