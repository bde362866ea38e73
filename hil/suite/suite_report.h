// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "hil/suite/suite_result.h"

namespace kerfbench::suite {

/// Name of the summary in the folder of a suite.
inline constexpr const char* kSummary = "summary.json";
/// The schema_version of summary.json.
inline constexpr int kSummarySchema = 1;

/// The table for a terminal: a line for each run, what is not as expected with the reason below it.
std::vector<std::string> tableLines(const SuiteResult& result);
/// One sentence: how many runs are as expected and how many are not.
std::string headline(const SuiteResult& result);

/// summary.json: no times and no paths but those within the suite's folder, so that two suites of the same
/// inputs have the same bytes, at any number of runs at once and after any interruption.
std::string summaryJson(const SuiteResult& result);
/// junit.xml: a test case for each run, with its values and links in system-out. `folder`: where the file
/// will be; links for the page of a CI (GitLab) are relative to the current folder if that is above it.
std::string junitXml(const SuiteResult& result, const std::filesystem::path& folder);
/// index.html: the same for people, with links to the reports of the runs.
std::string indexPage(const SuiteResult& result);

/// Writes the three into the folder, each whole or not at all, the summary last.
/// @throws std::system_error.
void writeReports(const SuiteResult& result, const std::filesystem::path& folder);

/// Path of a run's report from the suite's folder.
std::string reportLink(const SuiteRow& row);

}  // namespace kerfbench::suite
