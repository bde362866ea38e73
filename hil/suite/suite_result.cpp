// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/suite_result.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/exit_codes.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/text.h"
#include "hil/batch/job_folder.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;

constexpr int kExitFail = 1;  // FAIL, and whatever is not as expected and gives no other code.

/// The last line of the log that says something.
std::string lastWords(const fs::path& job_folder) {
  const std::string text = base::fileContent(job_folder / batch::kJobLog).value_or("");
  std::string_view rest = base::trimmed(text);
  if (const std::size_t end_of_line = rest.rfind('\n'); end_of_line != std::string_view::npos)
    rest.remove_prefix(end_of_line + 1);
  return base::printable(rest, 300);
}

SuiteRow& breakRow(SuiteRow& row, const std::string& why, int exit_code) {
  row.outcome = Outcome::kBroken;
  row.why = why;
  row.exit_code = exit_code;
  row.verdict.reset();
  return row;
}

/// "FAIL by path, stillness_x"; "INVALID: the first problem".
std::string describeVerdict(const RunVerdict& verdict) {
  std::vector<std::string> by;
  for (const inspect::Check& check : verdict.checks)
    if (verdict.verdict != "PASS" && inspect::verdictName(check.verdict) == verdict.verdict)
      by.push_back(check.name);
  if (!by.empty()) return fmt::format("{} by {}", verdict.verdict, fmt::join(by, ", "));
  return verdict.problems.empty() ? verdict.verdict
                                  : fmt::format("{}: {}", verdict.verdict, verdict.problems.front());
}

/// What parts a verdict from what is expected; empty: nothing.
std::string partingOf(const Expectation& expect, const RunVerdict& verdict) {
  if (verdict.verdict != expect.verdict)
    return fmt::format("{}, and {} is expected", describeVerdict(verdict), describe(expect));
  std::string missing;
  for (const std::string& name : expect.by) {
    const auto check = std::ranges::find(verdict.checks, name, &inspect::Check::name);
    if (check != verdict.checks.end() && inspect::verdictName(check->verdict) == expect.verdict) continue;
    missing += fmt::format("; check {} {}", name,
                           check == verdict.checks.end()
                               ? "was not made"
                               : fmt::format("is {}", inspect::verdictName(check->verdict)));
  }
  return missing.empty()
             ? missing
             : fmt::format("{}, and {} is expected{}", describeVerdict(verdict), describe(expect), missing);
}

}  // namespace

std::string outcomeName(Outcome outcome) {
  constexpr std::array kNames{"as expected", "not as expected", "broken", "not run"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

std::size_t SuiteResult::count(Outcome outcome) const {
  return static_cast<std::size_t>(std::ranges::count(rows, outcome, &SuiteRow::outcome));
}

int SuiteResult::exitCode() const {
  int code = 0;
  for (const SuiteRow& row : rows) code = base::worstExitCode(code, row.exit_code);
  return code;
}

fs::path jobFolder(const fs::path& suite_folder, const PlannedRun& run) {
  return suite_folder / "runs" / run.folderName();
}

fs::path resultsFolder(const fs::path& job_folder) { return job_folder / "results"; }

bool hasVerdict(const batch::JobEnd& end) {
  return std::ranges::any_of(std::array{0, 1, 3, 4}, [&](int code) { return end.exitedWith(code); });
}

SuiteRow rowOf(const PlannedRun& run, const fs::path& job_folder, const batch::JobOutcome& outcome) {
  SuiteRow row;
  row.run = run;
  row.wall_s = outcome.end.wall_s;
  row.earlier_tries = outcome.earlier_tries;
  if (!hasVerdict(outcome.end)) {
    const std::string words = lastWords(job_folder);
    const bool refused = outcome.end.exitedWith(base::kExitInput);
    return breakRow(
        row, words.empty() ? batch::describe(outcome.end) : batch::describe(outcome.end) + ": " + words,
        refused ? base::kExitInput : base::kExitBroken);
  }
  try {
    row.verdict = readRunVerdict(resultsFolder(job_folder));
  } catch (const base::InputError& e) {
    return breakRow(row, e.what(), base::kExitBroken);
  }
  if (row.verdict->exit_code != outcome.end.code)
    return breakRow(
        row, fmt::format("{}, and its verdict is {}", batch::describe(outcome.end), row.verdict->verdict),
        base::kExitBroken);
  row.why = partingOf(run.expect, *row.verdict);
  row.outcome = row.why.empty() ? Outcome::kAsExpected : Outcome::kNotAsExpected;
  if (!row.why.empty()) row.exit_code = row.verdict->exit_code == 0 ? kExitFail : row.verdict->exit_code;
  return row;
}

}  // namespace kerfbench::suite
