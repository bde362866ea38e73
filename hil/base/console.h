// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>

#include "hil/base/event_log.h"
#include "hil/base/progress.h"
#include "hil/base/time_left.h"

namespace kerfbench::base {

/// Progress of a run for the user: one line that is rewritten on a terminal, nothing of it in a log. Programs
/// that watch the run are told by events, if a file for them is given, quiet or not.
class Console {
 public:
  /// @throws std::system_error if `events` is given and cannot be written.
  explicit Console(bool quiet, const std::filesystem::path& events = {});
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// A line that stays (standard output); silent when quiet.
  void say(const std::string& line);
  /// A line that stays even when quiet.
  void result(const std::string& line);
  /// Progress of the work; now_s < 0: without virtual time.
  void progress(double now_s, const std::string& what);
  /// Progress is told without a terminal as well: a line for each work, and one in ten seconds.
  void beVerbose(bool verbose) { verbose_ = verbose; }
  /// Takes the line of progress away, before something else is written to standard error.
  void endProgress();
  /// About how much virtual time the work will take, so that events tell the share that is done; 0: unknown.
  void expect(double total_s) { expected_s_ = total_s; }
  /// Tells those who watch, if anybody does.
  void event(std::string_view name, std::initializer_list<EventField> fields);
  /// Null: nobody watches. It lives as long as this.
  [[nodiscard]] EventLog* events() const { return events_.get(); }

 private:
  void tellProgress(double now_s, const std::string& what);

  bool quiet_;
  bool terminal_;
  bool verbose_{false};
  bool progress_shown_{false};
  TimeLeft left_;
  std::string logged_;
  std::chrono::steady_clock::time_point next_logged_{};
  std::unique_ptr<EventLog> events_;
  double expected_s_{};
  std::string told_what_;
  std::chrono::steady_clock::time_point next_told_{};
};

/// Callback that shows progress on the console, which must outlive it.
ProgressFn progressOn(Console& console);

}  // namespace kerfbench::base
