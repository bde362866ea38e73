// SPDX-License-Identifier: Apache-2.0
#include "hil/batch/run_jobs.h"

#include <poll.h>
#include <signal.h>

#include <cerrno>
#include <chrono>
#include <list>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "hil/base/input_error.h"
#include "hil/base/parallel.h"
#include "hil/batch/job_folder.h"
#include "hil/batch/job_process.h"

namespace kerfbench::batch {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr int kPause_ms = 1000;  // Between two calls of waiting().

void refuseBadFolders(const FolderLock& lock, const std::vector<Job>& jobs) {
  std::set<fs::path> folders;
  for (const Job& job : jobs) {
    const fs::path folder = fs::absolute(job.folder).lexically_normal();
    const std::string inside = folder.lexically_relative(lock.folder()).generic_string();
    if (inside.empty() || inside == "." || inside.starts_with(".."))
      throw std::invalid_argument(folder.string() + " is not in " + lock.folder().string());
    if (!folders.insert(folder).second) throw std::invalid_argument(folder.string() + " is that of two jobs");
  }
}

/// Jobs from the first start to the last end.
class Batch {
 public:
  Batch(const std::vector<Job>& jobs, const BatchOptions& options) : jobs_(jobs), options_(options) {
    result_.jobs.resize(jobs.size());
  }

  BatchEnd run() {
    look();
    while (startAll() || !running_.empty()) wait();
    return std::move(result_);
  }

 private:
  struct Running {
    std::size_t job;
    JobProcess process;
  };

  /// What the folders hold: results that are kept are told, the others are waiting.
  void look() {
    std::vector<JobFolder> folders(jobs_.size());
    base::forEachIndex(jobs_.size(), options_.at_once, [&](std::size_t i) { folders[i] = lookAt(jobs_[i]); });
    std::string refused;
    for (const JobFolder& folder : folders) {
      if (folder.state == JobFolder::State::kOtherInputs || folder.state == JobFolder::State::kForeign)
        refused += (refused.empty() ? "" : "\n") + folder.why;
    }
    if (!refused.empty()) throw base::InputError(refused);
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      const JobFolder& folder = folders[i];
      const bool whole = folder.state == JobFolder::State::kWhole;
      if (!whole || (options_.runs_again && options_.runs_again(*folder.end))) {
        waiting_.push_back(i);
        makeRoom(jobs_[i], folder);
      } else {
        ended(i, {*folder.end, true, asideOf(jobs_[i].folder)});
      }
    }
  }

  /// The folder of a job that is to be run is empty or not there afterwards.
  void makeRoom(const Job& job, const JobFolder& folder) const {
    if (folder.state == JobFolder::State::kUnfinished) {
      fs::remove_all(job.folder);
    } else if (folder.state != JobFolder::State::kAbsent) {
      const fs::path aside = setAside(job.folder);
      if (options_.remark && !folder.why.empty())
        options_.remark(fmt::format("{}; it is kept as {}, and run again", folder.why, aside.string()));
    }
  }

  /// Starts what may run now. False: nothing is left to start.
  bool startAll() {
    while (!stopped_ && !waiting_.empty() && mayStart(jobs_[waiting_.front()])) {
      start(waiting_.front());
      waiting_.pop_front();
    }
    return !stopped_ && !waiting_.empty();
  }

  [[nodiscard]] bool mayStart(const Job& job) const {
    if (running_.empty()) return true;
    const bool one_is_alone = running_.size() == 1 && jobs_[running_.front().job].alone;
    return !job.alone && !one_is_alone && running_.size() < static_cast<std::size_t>(options_.at_once);
  }

  void start(std::size_t i) {
    fs::create_directories(jobs_[i].folder);
    running_.push_back({i, JobProcess(jobs_[i].command, jobs_[i].folder / kJobLog)});
  }

  void wait() {
    if (options_.waiting) {
      std::vector<std::size_t> running;
      for (const Running& one : running_) running.push_back(one.job);
      options_.waiting(running);
    }
    std::vector<pollfd> fds;
    for (const Running& one : running_) fds.push_back({one.process.fd(), POLLIN, 0});
    if (options_.signals != nullptr) fds.push_back({options_.signals->fd(), POLLIN, 0});
    const int ready = ::poll(fds.data(), fds.size(), kPause_ms);
    if (ready < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "poll");
    // A job that has ended by itself has a result, whatever came in the same moment.
    if (ready > 0) finish(fds);
    passOnSignals();
  }

  void finish(const std::vector<pollfd>& fds) {
    std::size_t k = 0;
    for (auto one = running_.begin(); one != running_.end(); ++k) {
      if (fds[k].revents == 0) {
        ++one;
        continue;
      }
      const std::size_t i = one->job;
      const JobEnd end = one->process.finish();
      one = running_.erase(one);
      if (result_.signal) {
        fs::remove_all(jobs_[i].folder);
        continue;
      }
      recordEnd(jobs_[i], end);
      ended(i, {end, false, asideOf(jobs_[i].folder)});
    }
  }

  void ended(std::size_t i, const JobOutcome& outcome) {
    result_.jobs[i] = outcome;
    if (options_.ended && !options_.ended(i, outcome)) stopped_ = true;
  }

  void passOnSignals() {
    while (options_.signals != nullptr) {
      const std::optional<int> signal = options_.signals->take();
      if (!signal) break;
      send(result_.signal ? SIGKILL : SIGTERM);
      if (!result_.signal)
        kill_at_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                      std::chrono::duration<double>(options_.grace_s));
      result_.signal = result_.signal.value_or(*signal);
      stopped_ = true;
    }
    if (result_.signal && Clock::now() >= kill_at_) send(SIGKILL);
  }

  void send(int signal) const {
    for (const Running& one : running_) one.process.signal(signal);
  }

  const std::vector<Job>& jobs_;
  const BatchOptions& options_;
  BatchEnd result_;
  std::list<std::size_t> waiting_;
  std::list<Running> running_;
  bool stopped_{};
  Clock::time_point kill_at_{};
};

}  // namespace

BatchEnd runJobs(const FolderLock& lock, const std::vector<Job>& jobs, const BatchOptions& options) {
  refuseBadFolders(lock, jobs);
  return Batch(jobs, options).run();
}

}  // namespace kerfbench::batch
