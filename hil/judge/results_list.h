// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kerfbench::judge {

/// File in each results folder that lists what a run wrote there: below a head line, for each file its
/// SHA-256 and its path as `sha256sum` prints them. Only a folder that has it, and nothing else, is replaced
/// by a later run.
inline constexpr const char* kResultsList = "kerfbench-results.txt";

/// Lists what the folder holds, in the folder. @throws std::system_error.
void writeResultsList(const std::filesystem::path& folder);

/// Why the folder may hold something that no run wrote; empty if all in it is listed, or nothing is in it.
std::string foreignIn(const std::filesystem::path& folder);

/// What of the folder is not as its list has it, a sentence each: files changed, missing, added, or listed
/// without a sum. @throws base::InputError for a folder without a list, std::system_error.
std::vector<std::string> changedSinceListed(const std::filesystem::path& folder);

}  // namespace kerfbench::judge
