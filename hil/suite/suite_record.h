// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil/suite/plan.h"

namespace kerfbench::suite {

/// File in the folder of a suite: what it was begun with. It is written once, and holds a suite that is
/// resumed to the same inputs.
inline constexpr const char* kSuiteRecord = "suite.json";

/// What a suite was begun with.
struct SuiteRecord {
  std::string name;
  std::string bench_version;
  std::string program_sha256;
  std::filesystem::path image;  ///< The release under test; absolute; empty: none was given.
  Selection selection;
  std::string part;  ///< How the runs were selected, in words.
  std::size_t left_out{};
  struct Run {
    std::string inputs;    ///< See inputsOf().
    std::string expected;  ///< Expectation and tags, in words.
    bool operator==(const Run&) const = default;
  };
  std::vector<std::pair<std::string, Run>> runs;  ///< Names and what was recorded, in the order of the plan.
  std::map<std::filesystem::path, std::string> files;  ///< All on which a run depends -> SHA-256.
};

/// Sum of everything on which a run depends: files by their content, options, the program.
std::string inputsOf(const PlannedRun& run, const std::string& program_sha256);

/// What a suite of this plan is begun with.
SuiteRecord recordOf(const Plan& plan, const std::string& bench_version, const std::string& program_sha256);

/// Writes the record into the folder of the suite. @throws std::system_error.
void writeRecord(const SuiteRecord& record, const std::filesystem::path& folder);
/// @throws base::InputError that names the folder: no suite was begun there, its record is broken, or one of
/// another version.
SuiteRecord readRecord(const std::filesystem::path& folder);

/// @throws base::InputError with everything that has changed since a suite was begun, a line each.
void refuseChanged(const SuiteRecord& begun, const SuiteRecord& now, const std::filesystem::path& folder);

}  // namespace kerfbench::suite
