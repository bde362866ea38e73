// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hil/serve/answer.h"
#include "hil/serve/work_folder.h"

namespace kerfbench::serve {

/// What a run is asked to be.
struct RunWish {
  std::string scenario;               ///< Name of a file (WorkFolder).
  std::string image;                  ///< The same; empty: the scenario's.
  bool trace{true};                   ///< Records a trace, which can be watched meanwhile.
  std::optional<std::uint64_t> seed;  ///< Instead of the scenario's.
  std::string serial_number;          ///< What is tested; may be empty.
};
/// @throws Refusal 400 with what is wrong with it.
RunWish runWishFrom(const nlohmann::json& json);

/// Runs of scenarios as child processes, `kerfbench run …` in the folder, one at a time; others wait in the
/// order in which they came. The kernel ends them with this process, however it ends. May be used by several
/// threads.
class Runs {
 public:
  /// Runs that are remembered, and those that may wait.
  static constexpr std::size_t kMostKept = 200;
  static constexpr std::size_t kMostWaiting = 20;

  /// `program`: kerfbench.
  Runs(const WorkFolder& files, std::filesystem::path program);
  /// Ends what runs.
  ~Runs();
  Runs(const Runs&) = delete;
  Runs& operator=(const Runs&) = delete;

  /// Starts a run, or has it wait. Gives {"id", "command"}. @throws Refusal 404 for a file that is not there,
  /// 409 if too many wait.
  nlohmann::json add(const RunWish& wish);
  /// All that are known, the newest first: [as of()].
  [[nodiscard]] nlohmann::json list() const;
  ///     {"id", "scenario", "state": "waiting" | "running" | "ended" | "stopped", "command", "serial_number",
  ///      "name", "progress": {"now_s"?, "share"?, "what", "left_s"?}, "exit_code"?, "verdict"?, "results"?,
  ///      "report"?, "trace"?, "problem"?,
  ///      "live": {"pins"?, "operator"?, "problems": []}}
  /// Live is what the run tells of real pins (docs/reference/events.md).
  /// @throws Refusal 404.
  [[nodiscard]] nlohmann::json of(const std::string& id) const;
  /// SIGINT, and after kGrace_s the end. One that waits does not begin. @throws Refusal 404.
  void stop(const std::string& id);
  /// Events of a run: state (as of()), log {"line"}, progress, and what the run itself tells. @throws Refusal
  /// 404.
  [[nodiscard]] std::unique_ptr<AnswerBody> events(const std::string& id, std::uint64_t after) const;
  /// The trace of a run from a byte on, until the run has ended. @throws Refusal 404, also where none is
  /// recorded.
  [[nodiscard]] std::unique_ptr<AnswerBody> trace(const std::string& id, std::uint64_t from) const;

  static constexpr double kGrace_s = 10.0;
  static constexpr double kGraceAtEnd_s = 2.0;  ///< When the server itself ends.

 private:
  class Run;
  void work();
  [[nodiscard]] std::shared_ptr<Run> find(const std::string& id) const;
  [[nodiscard]] std::shared_ptr<Run> nextOne();

  const WorkFolder& files_;
  std::filesystem::path program_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::shared_ptr<Run>> runs_;  ///< The oldest first.
  std::uint64_t last_id_{};
  bool ending_{};
  std::thread thread_;  ///< Starts all children: they end with it.
};

/// A command as one types it into a shell.
std::string shellLine(const std::vector<std::string>& words);

}  // namespace kerfbench::serve
