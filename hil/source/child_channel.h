// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hil/base/unique_fd.h"

namespace kerfbench::source {

/// @throws std::system_error always.
[[noreturn]] void throwErrno(int error, const std::string& what);

/// Byte stream to and from a child, whatever carries it.
class ChildChannel {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Io { kDone, kClosed, kTimedOut };

  virtual ~ChildChannel() = default;
  ChildChannel(const ChildChannel&) = delete;
  ChildChannel& operator=(const ChildChannel&) = delete;

  /// Writes to the child; one that has ended is an answer (kClosed), not a signal.
  Io write(std::span<const std::uint8_t> bytes, Clock::time_point deadline);
  /// Fills the whole of `into`.
  Io read(std::span<std::uint8_t> into, Clock::time_point deadline);

  /// Closes the way to the child and gives it a moment to end. Returns in words how it ended.
  virtual std::string finish(std::chrono::milliseconds patience) = 0;
  /// Ends it at once.
  virtual void kill() = 0;
  /// Process of this computer; -1 if there is none, or none any more.
  [[nodiscard]] virtual pid_t id() const { return -1; }
  /// Last words of the child on stderr, line breaks as " | "; empty where nobody hears them.
  [[nodiscard]] std::string lastWords();

 protected:
  ChildChannel() = default;
  /// `requests` is a pipe or a socket, and becomes non-blocking as the others do; `stderr_of_child` may be
  /// empty.
  void carry(base::UniqueFd requests, base::UniqueFd replies, base::UniqueFd stderr_of_child);
  void closeRequests() { requests_.reset(); }
  void closeReplies() { replies_.reset(); }
  bool drainStderr();
  /// Waits for the child's end of its stderr, which closes when the child ends, but no longer than a few
  /// milliseconds.
  void waitForStderr(Clock::time_point deadline);

 private:
  bool waitFor(short events, int fd, Clock::time_point deadline);
  /// Fetches what the child has written, at least a byte; nothing on a false alarm. All that was fetched
  /// before must have been taken.
  Io fetch(Clock::time_point deadline);

  base::UniqueFd requests_;
  base::UniqueFd replies_;
  base::UniqueFd stderr_;
  std::string stderr_tail_;
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(65536);
  std::span<const std::uint8_t> fetched_;  ///< What the last read() has brought and nobody has taken.
};

/// Time to wait in poll(), at most an hour; 0 where the deadline has passed.
int millisecondsTo(ChildChannel::Clock::time_point deadline);

}  // namespace kerfbench::source
