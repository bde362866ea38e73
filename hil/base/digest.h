// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace kerfbench::base {

/// SHA-256 as 64 lower-case hex digits.
std::string sha256(std::string_view bytes);
/// XXH3 of 128 bits as 32 lower-case hex digits: a hundred times quicker, for data that nobody forges.
std::string checksum(std::span<const std::uint8_t> bytes);
/// @throws std::system_error if the file cannot be read.
std::string sha256File(const std::filesystem::path& path);

}  // namespace kerfbench::base
