// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "hil/base/atomic_file.h"
#include "hil/base/text.h"
#include "hil/batch/job_folder.h"
#include "hil/suite/suite_report.h"

namespace kerfbench::suite {
namespace {

constexpr std::size_t kLongestText = 1000;  // Bytes of a reason.

std::string runs(std::size_t count) { return fmt::format("{} run{}", count, count == 1 ? "" : "s"); }

}  // namespace

std::string headline(const SuiteResult& result) {
  std::string text =
      fmt::format("{} of {} as expected", result.count(Outcome::kAsExpected), runs(result.rows.size()));
  for (const Outcome outcome : {Outcome::kNotAsExpected, Outcome::kBroken, Outcome::kNotRun}) {
    if (const std::size_t count = result.count(outcome); count > 0)
      text += fmt::format(", {} {}", count, outcomeName(outcome));
  }
  if (result.left_out > 0) text += fmt::format("; {} of the plan left out", runs(result.left_out));
  return text;
}

std::vector<std::string> tableLines(const SuiteResult& result) {
  std::size_t width = 4;
  for (const SuiteRow& row : result.rows) width = std::max(width, row.run.name.size());
  std::vector<std::string> lines;
  for (const SuiteRow& row : result.rows) {
    const bool bad = row.outcome != Outcome::kAsExpected;
    const inspect::Check* const nearest = row.verdict ? nearestToLimit(*row.verdict) : nullptr;
    const std::string what = row.verdict ? row.verdict->verdict : outcomeName(row.outcome);
    const std::string figures =
        nearest == nullptr ? std::string() : fmt::format("  {} {}", nearest->name, figuresOf(*nearest));
    lines.push_back(fmt::format("{} {:<{}}  {:<10}{}", bad ? "!" : " ", row.run.name, width, what, figures));
    if (bad && !row.why.empty()) lines.push_back("    " + base::printable(row.why, kLongestText));
  }
  return lines;
}

std::string reportLink(const SuiteRow& row) {
  return (resultsFolder(jobFolder({}, row.run)) / "report.html").generic_string();
}

void writeReports(const SuiteResult& result, const std::filesystem::path& folder) {
  base::writeFileAtomically(folder / "index.html", indexPage(result));
  base::writeFileAtomically(folder / "junit.xml", junitXml(result, folder));
  base::writeFileAtomically(folder / kSummary, summaryJson(result));
}

}  // namespace kerfbench::suite
