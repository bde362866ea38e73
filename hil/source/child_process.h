// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "hil/source/child_channel.h"

namespace kerfbench::source {

/// A child process with its stdin and stdout as a byte stream and the tail of its stderr kept. Killed and
/// reaped by the destructor at the latest: never a zombie.
class ChildProcess final : public ChildChannel {
 public:
  /// @throws std::system_error with the program's path.
  explicit ChildProcess(const std::filesystem::path& program);
  ~ChildProcess() override;

  /// Kills a child whose patience is over.
  std::string finish(std::chrono::milliseconds patience) override;
  void kill() override;
  [[nodiscard]] pid_t id() const override { return pid_; }

 private:
  pid_t pid_{-1};
  int status_{};
};

}  // namespace kerfbench::source
