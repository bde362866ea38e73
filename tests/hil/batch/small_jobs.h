// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include <gtest/gtest.h>

#include "hil/base/unique_fd.h"
#include "hil/batch/folder_lock.h"
#include "hil/batch/job.h"
#include "tests/hil/base/temp_folder.h"

namespace kerfbench::batch {

/// Jobs of a line of shell each, in a folder of their own. In the line $0 is the job's folder, and $1 a file
/// beside all of them to which lines are added.
class SmallJobs {
 public:
  [[nodiscard]] Job job(const std::string& name, const std::string& line) const {
    const std::filesystem::path folder = temp_.path() / "runs" / name;
    return {name, {"/bin/sh", "-c", line, folder.string(), notes().string()}, folder, "inputs of " + name};
  }
  [[nodiscard]] const std::filesystem::path& folder() const { return temp_.path(); }
  [[nodiscard]] std::filesystem::path notes() const { return temp_.path() / "notes"; }
  [[nodiscard]] std::string noted() const { return base::contentOf(notes()); }

 private:
  base::TempFolder temp_;
};

/// A pipe with a name, by which a job and a test wait for each other.
class NamedPipe {
 public:
  explicit NamedPipe(std::filesystem::path path) : path_(std::move(path)) {
    if (::mkfifo(path_.c_str(), 0600) != 0)
      throw std::system_error(errno, std::generic_category(), path_.string());
    // Both ends at once, so that neither side waits for the other to open.
    fd_ = base::UniqueFd(::open(path_.c_str(), O_RDWR | O_CLOEXEC));
  }
  [[nodiscard]] std::string path() const { return path_.string(); }
  /// The next line that a job writes.
  [[nodiscard]] std::string line() const {
    std::string text;
    for (char c = 0; ::read(fd_.get(), &c, 1) == 1 && c != '\n';) text += c;
    return text;
  }
  /// Leaves the writing to the jobs. Afterwards ends() tells when the last of them is gone.
  void onlyReads() { fd_ = base::UniqueFd(::open(path_.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)); }
  /// Whether the last writer goes away, within a time that only a hang takes.
  [[nodiscard]] bool ends() const {
    pollfd fd{fd_.get(), 0, 0};
    return ::poll(&fd, 1, 60'000) == 1 && (fd.revents & POLLHUP) != 0;
  }

 private:
  std::filesystem::path path_;
  base::UniqueFd fd_;
};

}  // namespace kerfbench::batch
