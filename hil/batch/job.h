// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kerfbench::batch {

/// A command to run, and a folder of its own for what it writes.
struct Job {
  std::string name;                  ///< For people.
  std::vector<std::string> command;  ///< Program, as an absolute path, and its arguments.
  /// Nothing else may use it. The command finds it there, and may write anything into it but kJobRecord and
  /// kJobLog (hil/batch/job_folder.h).
  std::filesystem::path folder;
  /// Sum of everything on which the result depends: files by their content, options, the program. A result is
  /// kept only if it is one of the same inputs.
  std::string inputs;
  bool alone{};  ///< Nothing runs beside it: for what has hardware to itself.
};

/// How a job ended.
struct JobEnd {
  enum class How {
    kExited,      ///< `code` is the exit code.
    kSignal,      ///< `code` is the number of the signal that ended it: it crashed or was killed.
    kNotStarted,  ///< `code` is the errno of the system: there is no such program, say.
  };
  How how{How::kExited};
  int code{};
  double wall_s{};  ///< Time on the wall clock; >= 0. No result depends on it.

  [[nodiscard]] bool exitedWith(int exit_code) const { return how == How::kExited && code == exit_code; }
};

/// A sentence's end: "ended with exit code 1", "was ended by signal 11 (Segmentation fault)", "could not be
/// started: No such file or directory".
std::string describe(const JobEnd& end);

}  // namespace kerfbench::batch
