// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace kerfbench::hil {

/// SHA-256 as 64 lower-case hex digits.
std::string sha256(std::string_view bytes);
/// @throws std::system_error if the file cannot be read.
std::string sha256File(const std::filesystem::path& path);

}  // namespace kerfbench::hil
