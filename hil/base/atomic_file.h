// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>

namespace kerfbench::base {

/// Writes a file whole or not at all: a temporary next to it, fsync, rename, fsync of the folder.
/// @throws std::system_error with the path.
void writeFileAtomically(const std::filesystem::path& path, std::string_view content);

}  // namespace kerfbench::base
