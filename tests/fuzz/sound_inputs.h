// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace kerfbench::fuzz {

/// Bytes of a file; empty where there is none.
std::string contentOf(const std::filesystem::path& path);

/// A sound input for targets whose readers take one that is short: name of the target, bytes.
std::vector<std::pair<std::string, std::string>> soundInputs();

}  // namespace kerfbench::fuzz
