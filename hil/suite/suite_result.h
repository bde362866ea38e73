// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hil/batch/job.h"
#include "hil/batch/run_jobs.h"
#include "hil/suite/plan.h"
#include "hil/suite/run_verdict.h"

namespace kerfbench::suite {

/// How a run came out, as the suite sees it.
enum class Outcome {
  kAsExpected,
  kNotAsExpected,
  kBroken,  ///< No verdict came of it: a refused input, a crash, a program that is not there.
  kNotRun,
};
/// "as expected", "not as expected", "broken", "not run".
std::string outcomeName(Outcome outcome);

/// One run of a suite, run or not.
struct SuiteRow {
  PlannedRun run;
  Outcome outcome{Outcome::kNotRun};
  std::string why;                    ///< A sentence; empty of what is as expected.
  std::optional<RunVerdict> verdict;  ///< Nothing where the run gave none.
  double wall_s{};                    ///< No part of any file that is compared.
  int earlier_tries{};                ///< See batch::JobOutcome.
  int exit_code{};  ///< What it adds to the exit code of the suite; 0 of what is as expected.
};

/// A suite as far as it has got.
struct SuiteResult {
  std::string name, title;
  std::string image, image_sha256;  ///< Name of the release under test and its sum; empty: none was given.
  std::string bench_version;
  std::string part;        ///< How the runs were selected, in words; empty: all of the plan.
  std::size_t left_out{};  ///< So many of the plan were not selected.
  std::vector<SuiteRow> rows;

  [[nodiscard]] std::size_t count(Outcome outcome) const;
  /// The worst of the rows', as of `kerfbench run`.
  [[nodiscard]] int exitCode() const;
};

/// Folders of a run in that of its suite: that of its job, and the results in it.
std::filesystem::path jobFolder(const std::filesystem::path& suite_folder, const PlannedRun& run);
std::filesystem::path resultsFolder(const std::filesystem::path& job_folder);

/// Whether a run has given a verdict. One that has not is run again when the suite is resumed.
bool hasVerdict(const batch::JobEnd& end);

/// Judges a run that has ended by what is in its folder.
SuiteRow rowOf(const PlannedRun& run, const std::filesystem::path& job_folder,
               const batch::JobOutcome& outcome);

}  // namespace kerfbench::suite
