// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

// Private to hil/desk.
namespace kerfbench::desk {

/// Name of a file as one in `folder` gives it: relative, or the whole path where the two have no folder in
/// common.
inline std::string nameFromFolder(const std::filesystem::path& file, const std::filesystem::path& folder) {
  const std::filesystem::path whole = file.lexically_normal();
  const std::filesystem::path relative = whole.lexically_relative(folder.lexically_normal());
  const auto first = [](const std::filesystem::path& path) {
    const std::filesystem::path below = path.relative_path();
    return below.empty() ? std::filesystem::path() : *below.begin();
  };
  const bool is_apart = relative.empty() || first(whole) != first(folder.lexically_normal());
  return is_apart ? whole.generic_string() : relative.generic_string();
}

}  // namespace kerfbench::desk
