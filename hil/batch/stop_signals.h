// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>

#include <optional>

#include "hil/base/unique_fd.h"

namespace kerfbench::batch {

/// Keeps SIGINT, SIGTERM and SIGHUP from ending the process as long as this lives, and says that they came.
/// One that the process ignores, as below nohup, stays ignored. To be made before any other thread is: one
/// that does not block them would be ended by them.
class StopSignals {
 public:
  /// @throws std::system_error.
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Readable when one has come, for poll(2).
  [[nodiscard]] int fd() const { return fd_.get(); }
  /// The number of one that has come, each once; nullopt: none has.
  std::optional<int> take();

 private:
  sigset_t before_{};
  base::UniqueFd fd_;
};

}  // namespace kerfbench::batch
