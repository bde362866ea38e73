// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/base/progress.h"

namespace kerfbench::base {

/// Progress of a run for the user: one line that is rewritten on a terminal, nothing of it in a log.
class Console {
 public:
  explicit Console(bool quiet);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// A line that stays (standard output); silent when quiet.
  void say(const std::string& line);
  /// A line that stays even when quiet.
  void result(const std::string& line);
  /// Progress of the work; now_s < 0: without virtual time.
  void progress(double now_s, const std::string& what);
  /// Takes the line of progress away, before something else is written to standard error.
  void endProgress();

 private:
  bool quiet_;
  bool terminal_;
  bool progress_shown_{false};
};

/// Callback that shows progress on the console, which must outlive it.
ProgressFn progressOn(Console& console);

}  // namespace kerfbench::base
