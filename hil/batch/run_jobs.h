// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "hil/batch/folder_lock.h"
#include "hil/batch/job.h"
#include "hil/batch/stop_signals.h"

namespace kerfbench::batch {

/// How a job came out.
struct JobOutcome {
  JobEnd end;
  bool kept{};          ///< The folder held a whole result already: the job was not run.
  int earlier_tries{};  ///< Earlier results of it that were set aside, as NAME.1, NAME.2 … beside its folder.
};

/// How jobs are run, and who is told. All calls come from the thread of runJobs(), one at a time.
struct BatchOptions {
  int at_once{1};          ///< So many jobs run beside each other; >= 1.
  StopSignals* signals{};  ///< Stops the batch; may be null.
  double grace_s{5.0};     ///< Jobs that have not ended so long after a signal are killed; >= 0.
  /// Whether a whole result is of no use, so that the job is to be run again. Empty: every one is kept.
  std::function<bool(const JobEnd&)> runs_again{};
  /// A job has ended and its folder is whole, or it was kept; those that are kept come first. False: no
  /// further job is started; those that run go on to their ends.
  std::function<bool(std::size_t job, const JobOutcome& outcome)> ended{};
  /// What was found in a folder, a sentence: a damaged result was set aside, say.
  std::function<void(const std::string& remark)> remark{};
  /// Once a second or more often, with the jobs that run.
  std::function<void(const std::vector<std::size_t>& running)> waiting{};
};

/// How a batch ended.
struct BatchEnd {
  std::vector<std::optional<JobOutcome>> jobs;  ///< In the order of the jobs; nullopt: no result.
  std::optional<int> signal{};                  ///< The signal that stopped the batch.
};

/// Runs jobs as child processes, several at a time, started in their order. A job whose folder holds a whole
/// result of the same inputs (lookAt() of hil/batch/job_folder.h) is not run again, so that a batch which was
/// interrupted, by kill -9 or a loss of power as well, goes on where it was. Which jobs run beside each other
/// is left to chance: what a job writes must not depend on that.
///
/// Nothing is lost: a damaged result, and one that runs_again() refuses, is renamed before the job is run
/// again; only what an interrupted job left behind is removed.
///
/// A signal of options.signals is passed on to the jobs; those that have not ended grace_s later, or when it
/// comes once more, are killed. They have no result, and are run when the batch is resumed.
///
/// The children end with the calling thread, however that ends.
///
/// @param lock Keeps the folder in which those of all jobs are.
/// @throws base::InputError before anything runs, with all folders that hold results of other inputs or
/// something that no job wrote. std::system_error if a folder, a log or a record cannot be written (the disk
/// is full): all that run are killed, and what was recorded stays. std::invalid_argument: folders that are
/// not in the lock's, or not different.
BatchEnd runJobs(const FolderLock& lock, const std::vector<Job>& jobs, const BatchOptions& options);

}  // namespace kerfbench::batch
