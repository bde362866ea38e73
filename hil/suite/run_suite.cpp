// SPDX-License-Identifier: Apache-2.0
#include "hil/suite/run_suite.h"

#include <string.h>  // NOLINT(modernize-deprecated-headers): strsignal is no part of <cstring>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/atomic_file.h"
#include "hil/base/digest.h"
#include "hil/base/exit_codes.h"
#include "hil/base/input_error.h"
#include "hil/base/text.h"
#include "hil/base/version.h"
#include "hil/batch/run_jobs.h"
#include "hil/judge/results_list.h"
#include "hil/judge/run_folder.h"
#include "hil/suite/earlier_suite.h"
#include "hil/suite/plan.h"
#include "hil/suite/suite_record.h"
#include "hil/suite/suite_report.h"

namespace kerfbench::suite {
namespace {

namespace fs = std::filesystem;

constexpr int kSignalCodes = 128;  // A shell's exit code of a program that a signal ended.

/// A plan, what of it is run, and where.
struct Prepared {
  Plan plan;
  SuiteRecord record;
  fs::path folder;  ///< Absolute; of a new suite it is not there yet.
  bool resumed{};
};

std::string partOf(const SuiteOptions& options, const std::optional<fs::path>& repeated) {
  std::vector<std::string> words;
  if (!options.tags.empty()) words.push_back(fmt::format("tag {}", fmt::join(options.tags, " or ")));
  if (!options.patterns.empty()) words.push_back(fmt::format("name {}", fmt::join(options.patterns, " or ")));
  if (repeated)
    words.push_back(fmt::format("not as expected in {}", fs::canonical(*repeated).filename().string()));
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Where the suites of the plan are.
fs::path folderOfSuites(const SuiteOptions& options, const std::string& name) {
  return fs::absolute(options.results_dir).lexically_normal() / name;
}

/// The folder of an earlier suite: the one given, or the latest.
fs::path folderMeant(const SuiteOptions& options, const fs::path& given) {
  if (!given.empty()) return fs::absolute(given).lexically_normal();
  return folderOfSuites(options, nameOfPlan(options.plan)) / judge::kLatestRun;
}

/// The selection and the image of a new suite.
SuiteRecord askedFor(const SuiteOptions& options) {
  SuiteRecord asked;
  asked.selection = {options.tags, options.patterns, {}};
  asked.image = options.image.empty() ? fs::path() : fs::absolute(options.image).lexically_normal();
  std::optional<fs::path> repeated;
  if (options.failed) {
    repeated = folderMeant(options, *options.failed);
    const SuiteRecord earlier = readRecord(*repeated);
    asked.selection.names = namesNotAsExpected(*repeated);
    if (asked.image.empty()) asked.image = earlier.image;
  }
  asked.part = partOf(options, repeated);
  return asked;
}

Prepared prepare(const SuiteOptions& options) {
  Prepared prepared;
  SuiteRecord asked;
  if (options.resume) {
    prepared.resumed = true;
    prepared.folder = folderMeant(options, *options.resume);
    asked = readRecord(prepared.folder);
    prepared.folder = fs::canonical(prepared.folder);
  } else {
    asked = askedFor(options);
  }
  prepared.plan = readPlan(options.plan, {options.bin_dir, asked.image});
  const std::size_t left_out = select(prepared.plan, asked.selection);
  refuseUnfit(prepared.plan);
  prepared.record = recordOf(prepared.plan, base::version(), base::sha256File(options.program));
  if (prepared.resumed) refuseChanged(asked, prepared.record, prepared.folder);
  prepared.record.image = asked.image;
  prepared.record.selection = asked.selection;
  prepared.record.part = asked.part;
  prepared.record.left_out = left_out;
  return prepared;
}

/// The runs of a scenario of the plan's name are no suites.
void refuseRunsOfAScenario(const fs::path& suites) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(suites, error)) {
    if (fs::exists(entry.path() / judge::kResultsList))
      throw base::InputError(fmt::format(
          "{} holds the runs of a scenario; give the plan another name, or choose another --results-dir",
          suites.string()));
  }
}

/// A folder that was not there: results_dir/NAME/DATE-DIGEST.
fs::path newFolder(const SuiteOptions& options, const Prepared& prepared) {
  const fs::path suites = folderOfSuites(options, prepared.plan.name);
  judge::refuseBlockedRuns(options.results_dir, prepared.plan.name);
  refuseRunsOfAScenario(suites);
  std::string inputs;
  for (const auto& [name, run] : prepared.record.runs) inputs += fmt::format("{} {}\n", name, run.inputs);
  const std::string name = judge::runFolderName(std::chrono::system_clock::now(), base::sha256(inputs));
  fs::create_directories(suites);
  fs::path folder = suites / name;
  for (int number = 2; !fs::create_directory(folder); ++number)
    folder = suites / fmt::format("{}-{}", name, number);
  return folder;
}

/// The scenario that a run is given.
fs::path scenarioOf(const PlannedRun& run, const fs::path& folder) {
  return run.limited_scenario.empty() ? run.scenario : folder / "scenarios" / (run.folderName() + ".yaml");
}

std::vector<std::string> commandOf(const PlannedRun& run, const fs::path& folder, const SuiteOptions& options,
                                   int at_once) {
  const fs::path job = jobFolder(folder, run);
  std::vector<std::string> command{fs::absolute(options.program).string(),
                                   "run",
                                   scenarioOf(run, folder).string(),
                                   "--output",
                                   resultsFolder(job).string(),
                                   "--results-dir",
                                   job.string(),
                                   "--jobs",
                                   std::to_string(std::max(1, options.processors / at_once)),
                                   options.pictures ? "--pictures" : "--no-pictures"};
  const auto add = [&](const char* option, const std::string& value) {
    command.insert(command.end(), {option, value});
  };
  const RunChoices& choices = run.choices;
  if (choices.seed) add("--seed", std::to_string(*choices.seed));
  if (choices.imperfections) add("--imperfections", *choices.imperfections);
  if (choices.twin) add("--twin", *choices.twin);
  if (choices.time_limit_s) add("--time-limit", fmt::format("{}", *choices.time_limit_s));
  if (!run.image.empty()) add("--image", run.image.string());
  if (options.keep_evidence) command.emplace_back("--keep-evidence");
  return command;
}

/// What the folder of a suite has before its first run. The record comes last: with it the suite is begun.
void begin(const Prepared& prepared) {
  base::writeFileAtomically(prepared.folder / "plan.yaml", prepared.plan.text);
  fs::create_directories(prepared.folder / "scenarios");
  for (const PlannedRun& run : prepared.plan.runs) {
    if (!run.limited_scenario.empty())
      base::writeFileAtomically(scenarioOf(run, prepared.folder), run.limited_scenario);
  }
  writeRecord(prepared.record, prepared.folder);
  judge::linkLatest(prepared.folder);
}

/// A suite from its first run to its last.
class Suite {
 public:
  Suite(const Prepared& prepared, const SuiteOptions& options, base::Console& console)
      : options_(options), console_(console), folder_(prepared.folder) {
    result_.name = prepared.plan.name;
    result_.title = prepared.plan.title;
    result_.bench_version = base::version();
    result_.part = prepared.record.part;
    result_.left_out = prepared.record.left_out;
    if (!prepared.record.image.empty()) {
      result_.image = prepared.record.image.filename().string();
      result_.image_sha256 = base::sha256File(prepared.record.image);
    }
    stop_after_ = options.stop_after.value_or(prepared.plan.stop_after);
    at_once_ = std::clamp(options.jobs, 1, static_cast<int>(prepared.plan.runs.size()));
    for (std::size_t i = 0; i < prepared.plan.runs.size(); ++i) {
      const PlannedRun& run = prepared.plan.runs[i];
      result_.rows.push_back({.run = run});
      jobs_.push_back({run.name, commandOf(run, folder_, options, at_once_), jobFolder(folder_, run),
                       prepared.record.runs[i].second.inputs, run.on_real_pins});
    }
  }

  int run(const batch::FolderLock& lock) {
    batch::StopSignals signals;
    const batch::BatchEnd end = runJobs(
        lock, jobs_,
        {.at_once = at_once_,
         .signals = &signals,
         .runs_again = [](const batch::JobEnd& job) { return !hasVerdict(job); },
         .ended = [this](std::size_t job, const batch::JobOutcome& outcome) { return ended(job, outcome); },
         .remark = [this](const std::string& remark) { console_.result(remark); },
         .waiting = [this](const std::vector<std::size_t>& running) { tellProgress(running); }});
    tellWhyNotRun(end.signal);
    writeReports(result_, folder_);
    return tellEnd(end.signal);
  }

 private:
  bool ended(std::size_t i, const batch::JobOutcome& outcome) {
    SuiteRow& row = result_.rows[i];
    row = rowOf(row.run, jobs_[i].folder, outcome);
    ++ended_;
    wall_s_ += row.wall_s;
    const bool bad = row.outcome != Outcome::kAsExpected;
    bad_ += bad ? 1U : 0U;
    if (outcome.kept) return true;
    writeReports(result_, folder_);
    new_bad_ += bad ? 1U : 0U;
    console_.say(fmt::format("  [{}/{}] {}: {}{}", ended_, jobs_.size(), row.run.name,
                             row.verdict ? row.verdict->verdict : outcomeName(row.outcome),
                             bad && row.verdict ? ", not as expected" : ""));
    return stop_after_ == 0 || new_bad_ < stop_after_;
  }

  void tellProgress(const std::vector<std::size_t>& running) {
    std::vector<std::string> names;
    for (const std::size_t i : running) names.push_back(jobs_[i].name);
    const double mean_s = ended_ == 0 ? 0.0 : wall_s_ / static_cast<double>(ended_);
    console_.progress(-1.0, progressText(ended_, jobs_.size(), bad_, mean_s, at_once_, names));
  }

  void tellWhyNotRun(std::optional<int> signal) {
    const std::string why = signal
                                ? fmt::format("interrupted by signal {} ({})", *signal, ::strsignal(*signal))
                                : fmt::format("not started: {} run{} not as expected", new_bad_,
                                              new_bad_ == 1 ? " was" : "s were");
    for (SuiteRow& row : result_.rows)
      if (row.outcome == Outcome::kNotRun) row.why = why;
  }

  int tellEnd(std::optional<int> signal) {
    for (const std::string& line : tableLines(result_)) {
      if (line.starts_with("  ") && !line.starts_with("    "))
        console_.say(line);
      else
        console_.result(line);
    }
    console_.result(fmt::format("{}: {}", result_.name, headline(result_)));
    console_.say(fmt::format("page: {}", (folder_ / "index.html").string()));
    if (result_.count(Outcome::kNotRun) + result_.count(Outcome::kBroken) > 0)
      console_.say(
          fmt::format("go on: ./bench suite {} --resume {}", options_.plan.string(), folder_.string()));
    return signal ? kSignalCodes + *signal : result_.exitCode();
  }

  const SuiteOptions& options_;
  base::Console& console_;
  fs::path folder_;
  SuiteResult result_;
  std::vector<batch::Job> jobs_;
  int at_once_{1};
  std::size_t stop_after_{};
  std::size_t ended_{}, bad_{};
  std::size_t new_bad_{};  ///< Not as expected since this process began.
  double wall_s_{};        ///< Sum over the runs that have ended.
};

int listRuns(const Prepared& prepared, base::Console& console) {
  for (const PlannedRun& run : prepared.plan.runs) {
    console.result(fmt::format(
        "{}  {}  expected {}{}{}", run.name, run.scenario_as_written, describe(run.expect),
        run.tags.empty()
            ? ""
            : fmt::format("  [{}]", base::printable(fmt::format("{}", fmt::join(run.tags, ", ")), 200)),
        run.image.empty() ? "" : "  " + run.image.filename().string()));
  }
  console.say(fmt::format("{} to run, {} left out", prepared.plan.runs.size(), prepared.record.left_out));
  return 0;
}

}  // namespace

std::string progressText(std::size_t ended, std::size_t all, std::size_t bad, double mean_s, int at_once,
                         const std::vector<std::string>& running) {
  std::string text = fmt::format("{} of {} runs ({} %)", ended, all, all == 0 ? 100 : 100 * ended / all);
  if (bad > 0) text += fmt::format(", {} not as expected", bad);
  if (mean_s > 0.0) {
    const auto left = static_cast<double>(all - ended);
    const double left_s = mean_s * left / std::min(left, static_cast<double>(std::max(1, at_once)));
    text += left_s < 90.0 ? fmt::format(", about {:.0f} s left", std::ceil(left_s))
                          : fmt::format(", about {:.0f} min left", std::ceil(left_s / 60.0));
  }
  if (!running.empty()) text += fmt::format(": {}", fmt::join(running, ", "));
  return text;
}

int runSuite(const SuiteOptions& options, base::Console& console) {
  Prepared prepared = prepare(options);
  if (options.list) return listRuns(prepared, console);
  if (!prepared.resumed) prepared.folder = newFolder(options, prepared);
  const batch::FolderLock lock(prepared.folder);
  try {
    if (!prepared.resumed) begin(prepared);
    Suite suite(prepared, options, console);
    return suite.run(lock);
  } catch (const std::system_error& e) {
    console.result(
        fmt::format("{}\nwhat has ended is kept in {}: make room, or whatever is missing, and go on "
                    "with --resume",
                    e.what(), prepared.folder.string()));
    return base::kExitBroken;
  }
}

}  // namespace kerfbench::suite
