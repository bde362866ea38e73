// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "hil/base/unique_fd.h"

namespace kerfbench::source {

/// A child process with its stdin and stdout as a byte stream and the tail of its stderr kept. Killed and
/// reaped by the destructor at the latest: never a zombie.
class ChildProcess {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Io { kDone, kClosed, kTimedOut };

  /// @throws std::system_error with the program's path.
  explicit ChildProcess(const std::filesystem::path& program);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Writes to the child; one that has ended is an answer (kClosed), not a signal.
  Io write(std::span<const std::uint8_t> bytes, Clock::time_point deadline);
  /// Fills the whole of `into`.
  Io read(std::span<std::uint8_t> into, Clock::time_point deadline);

  /// Closes the child's stdin and gives it a moment to end, then kills it. Returns in words how it ended.
  std::string finish(std::chrono::milliseconds patience);
  void kill();
  /// -1 once it has been reaped.
  [[nodiscard]] pid_t id() const { return pid_; }
  /// Last words of the child on stderr, line breaks as " | ".
  [[nodiscard]] std::string lastWords();

 private:
  bool drainStderr();
  bool waitFor(short events, int fd, Clock::time_point deadline);
  /// Fetches what the child has written, at least a byte; nothing on a false alarm. All that was fetched
  /// before must have been taken.
  Io fetch(Clock::time_point deadline);

  pid_t pid_{-1};
  int status_{};
  base::UniqueFd requests_;
  base::UniqueFd replies_;
  base::UniqueFd stderr_;
  std::string stderr_tail_;
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(65536);
  std::span<const std::uint8_t> fetched_;  ///< What the last read() has brought and nobody has taken.
};

}  // namespace kerfbench::source
