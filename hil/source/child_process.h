// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/source/child_channel.h"

namespace kerfbench::source {

/// A child process with its stdin and stdout as a byte stream and the tail of its stderr kept. Killed and
/// reaped by the destructor at the latest, with what it has started: never a zombie.
class ChildProcess final : public ChildChannel {
 public:
  /// @param command Program, by its path, and its arguments.
  /// @throws std::system_error with the program's path.
  explicit ChildProcess(std::vector<std::string> command);
  ~ChildProcess() override;

  /// Kills a child whose patience is over.
  std::string finish(std::chrono::milliseconds patience) override;
  void kill() override;
  [[nodiscard]] pid_t id() const override { return pid_; }

 private:
  [[nodiscard]] bool hasEnded() const;

  pid_t pid_{-1};
  int status_{};
};

}  // namespace kerfbench::source
