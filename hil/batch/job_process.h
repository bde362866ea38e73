// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/stopwatch.h"
#include "hil/base/unique_fd.h"
#include "hil/batch/job.h"

namespace kerfbench::batch {

/// The child process of a job, in a process group of its own. It has no input, and its output goes to a file.
/// The kernel kills it when the thread that started it ends, however that happens; the destructor kills its
/// whole group. To be used by one thread.
class JobProcess {
 public:
  /// `folder`: in which it runs; empty: this process's own.
  /// @throws std::system_error if the log or a process cannot be made. A program that cannot be started, or a
  /// folder that is not there, is no such failure: finish() says so.
  JobProcess(const std::vector<std::string>& command, const std::filesystem::path& log,
             const std::filesystem::path& folder = {});
  ~JobProcess();
  JobProcess(JobProcess&& other) noexcept;
  JobProcess& operator=(JobProcess&&) = delete;
  JobProcess(const JobProcess&) = delete;
  JobProcess& operator=(const JobProcess&) = delete;

  /// Readable when the process has ended, for poll(2).
  [[nodiscard]] int fd() const { return pidfd_.get(); }
  /// Sends a signal to the process and its children.
  void signal(int number) const;
  /// Waits for its end, and kills what children it left.
  JobEnd finish();

 private:
  pid_t pid_{-1};
  base::UniqueFd pidfd_;
  base::Stopwatch stopwatch_;
  int not_started_{};  ///< errno, 0: the program was started.
};

}  // namespace kerfbench::batch
