// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>

#include <thread>

#include "hil/base/unique_fd.h"

namespace kerfbench::cli {

/// As long as this lives SIGINT, SIGTERM and SIGHUP end the process as they would without it, but leave
/// nothing behind: temporary files and folders are removed first (hil/base/temporary.h). A second signal ends
/// it at once. One that the process ignores, as below nohup, stays ignored; so is SIGPIPE, so that a run
/// whose reader has gone comes to its end. To be made before any other thread is: one that does not block the
/// signals would be ended by them.
class EndOnSignal {
 public:
  /// @throws std::system_error.
  EndOnSignal();
  ~EndOnSignal();
  EndOnSignal(const EndOnSignal&) = delete;
  EndOnSignal& operator=(const EndOnSignal&) = delete;

 private:
  void wait() const;

  sigset_t before_{};
  base::UniqueFd signals_, over_;
  std::thread thread_;
};

}  // namespace kerfbench::cli
