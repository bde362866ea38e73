// SPDX-License-Identifier: Apache-2.0
#include "hil/campaign/runner.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "hil/base/exit_codes.h"
#include "hil/base/file_content.h"
#include "hil/base/input_error.h"
#include "hil/base/temporary.h"
#include "hil/base/text.h"
#include "hil/batch/job_folder.h"
#include "hil/batch/run_jobs.h"
#include "hil/campaign/grid.h"
#include "hil/campaign/run_files.h"
#include "hil/compare/run_figures.h"

namespace kerfbench::campaign {
namespace {

namespace fs = std::filesystem;

constexpr std::array kVerdictCodes{0, 1, 3, 4};

std::string hostName() {
  std::array<char, 256> host{};
  if (::gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  return host.data();
}

/// What one try of a run came to: a record, or why there is none.
struct Try {
  std::optional<Record> record;
  std::string trouble;  ///< For people: what happened.
  std::string words;    ///< What the bench said when it broke; empty for a crash.
};

/// The runs of a shard, from the first start to the last record.
class Shard {
 public:
  Shard(const Campaign& campaign, const Prepared& prepared, const ShardOptions& options)
      : campaign_(campaign), prepared_(prepared), options_(options), records_(prepared.records()) {}

  ShardEnd run() {
    std::vector<std::size_t> wanted = wantedRuns();
    if (wanted.empty()) return std::move(end_);
    fs::create_directories(prepared_.scenarios());
    const base::TemporaryFolder work(prepared_.folder / "runs", hostName());
    const batch::FolderLock lock(work.path());
    runOnce(lock, wanted, "first");
    if (end_.signal || broken_.empty()) return std::move(end_);
    std::vector<std::size_t> again;
    for (const auto& [run, first] : broken_) again.push_back(run);
    is_second_ = true;
    runOnce(lock, again, "second");
    return std::move(end_);
  }

 private:
  std::vector<std::size_t> wantedRuns() {
    const std::vector<std::size_t> all = indicesOf(campaign_.runs(), options_.shard, options_.shards);
    all_ = all.size();
    std::vector<std::size_t> wanted;
    for (const std::size_t run : all) {
      const RecordFolder::Found found = records_.find(run);
      if (!found.damage.empty() && options_.remark) options_.remark(found.damage + "; the run is made again");
      if (found.line.empty()) {
        wanted.push_back(run);
      } else {
        ++end_.had;
      }
    }
    return wanted;
  }

  void runOnce(const batch::FolderLock& lock, const std::vector<std::size_t>& runs, const char* try_name) {
    std::vector<batch::Job> jobs;
    for (const std::size_t run : runs) {
      // What prepare() wrote; whoever has edited it since would have a run that is none of this campaign.
      const fs::path scenario = writeRunFiles(campaign_, planOf(campaign_, run), prepared_.scenarios());
      const fs::path folder = lock.folder() / try_name / runName(run);
      jobs.push_back({.name = runName(run),
                      .command = {options_.program.string(), "run", scenario.string(), "--results-dir",
                                  folder.string(), "--jobs", "1", "--no-pictures", "--quiet"},
                      .folder = folder,
                      .inputs = prepared_.identity});
    }
    batch::BatchOptions options{.at_once = options_.at_once, .signals = options_.signals};
    options.ended = [&](std::size_t job, const batch::JobOutcome& outcome) {
      take(runs[job], jobs[job], outcome.end);
      return true;
    };
    end_.signal = batch::runJobs(lock, jobs, options).signal;
  }

  void take(std::size_t run, const batch::Job& job, const batch::JobEnd& job_end) {
    Try tried = resultOf(run, job, job_end);
    const auto first = broken_.find(run);
    const bool broke_alike =
        is_second_ && first != broken_.end() && !tried.words.empty() && tried.words == first->second.words;
    if (!tried.record && broke_alike) {
      tried.record = recordOf(campaign_, planOf(campaign_, run));
      tried.record->outcome = kBroken;
      tried.record->reason = tried.words;
    }
    if (tried.record) {
      keepResults(*tried.record, job);
      records_.write(*tried.record);
      ++end_.made;
      if (options_.ended) options_.ended(*tried.record, end_.had + end_.made, all_);
    } else if (!is_second_) {
      if (options_.remark) options_.remark(fmt::format("run {} {}; it is tried again", run, tried.trouble));
      broken_[run] = std::move(tried);
    } else {
      end_.broken.push_back(fmt::format("run {} {}", run, tried.trouble));
    }
    std::error_code ignored;
    fs::remove_all(job.folder, ignored);
  }

  Try resultOf(std::size_t run, const batch::Job& job, const batch::JobEnd& job_end) const {
    Try tried;
    const std::string log = base::fileContent(job.folder / batch::kJobLog).value_or("");
    if (job_end.how == batch::JobEnd::How::kExited) {
      Record record = recordOf(campaign_, planOf(campaign_, run));
      if (std::ranges::find(kVerdictCodes, job_end.code) != kVerdictCodes.end()) {
        try {
          addVerdict(record, compare::readRunFigures(resultsIn(job), compare::Trust::kAsItIs));
          tried.record = std::move(record);
          return tried;
        } catch (const base::InputError& e) {
          tried.trouble = fmt::format("left no verdict: {}", e.what());
          return tried;
        }
      }
      if (job_end.code == base::kExitInput) {
        record.outcome = kRefused;
        record.reason = reasonIn(log);
        tried.record = std::move(record);
        return tried;
      }
      tried.words = reasonIn(log);
    }
    tried.trouble = fmt::format("{}: {}", batch::describe(job_end), reasonIn(log));
    return tried;
  }

  [[nodiscard]] fs::path resultsIn(const batch::Job& job) const {
    return job.folder / fmt::format("{}-{}", campaign_.name, job.name) / "latest";
  }

  void keepResults(const Record& record, const batch::Job& job) const {
    if (options_.keep == Keep::kNone || (options_.keep == Keep::kBad && record.outcome == "PASS")) return;
    const fs::path latest = resultsIn(job);
    if (!fs::exists(latest)) return;
    const fs::path place = prepared_.folder / "kept" / runName(record.run);
    fs::create_directories(place.parent_path());
    fs::remove_all(place);
    fs::rename(fs::canonical(latest), place);
  }

  const Campaign& campaign_;
  const Prepared& prepared_;
  const ShardOptions& options_;
  RecordFolder records_;
  ShardEnd end_;
  std::size_t all_{};
  bool is_second_{};
  std::map<std::size_t, Try> broken_;
};

}  // namespace

std::string reasonIn(const std::string& log) {
  std::string line;
  for (std::size_t at = 0; at < log.size() && line.empty();) {
    const std::size_t end = std::min(log.find('\n', at), log.size());
    line = std::string(base::trimmed(log.substr(at, end - at)));
    at = end + 1;
  }
  constexpr std::size_t kMostLetters = 300;
  std::string reason;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    const std::string word = line.substr(at, end - at);
    // "/a/b.yaml:3:" and "'../b.yaml'" are files, "mm/s" is none.
    const std::size_t first = std::min(word.find_first_not_of("'\"("), word.size());
    const std::size_t slash = word.rfind('/');
    const bool is_file = slash != std::string::npos && (word[first] == '/' || word[first] == '.');
    if (!reason.empty()) reason += ' ';
    reason += is_file ? word.substr(0, first) + word.substr(slash + 1) : word;
    at = end + 1;
  }
  return reason.empty() ? "it said nothing" : base::printable(reason, kMostLetters);
}

ShardEnd runShard(const Campaign& campaign, const Prepared& prepared, const ShardOptions& options) {
  return Shard(campaign, prepared, options).run();
}

void sweep(const Prepared& prepared) {
  std::error_code ignored;
  fs::remove_all(prepared.folder / "runs", ignored);
}

}  // namespace kerfbench::campaign
