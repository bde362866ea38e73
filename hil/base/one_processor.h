// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sched.h>
#include <sys/types.h>

namespace kerfbench::base {

/// Keeps the calling thread and a process that takes turns with it on one processor, whichever that is: a
/// processor that sleeps while the other one's work is done takes longer to wake than such a turn lasts.
/// Which processors both may use is as before after the destructor. Changes how long things take and nothing
/// else; where the system refuses, nothing happens.
class OneProcessor {
 public:
  /// `other`: the process; 0: there is none, and all calls do nothing. What is created by this thread, and
  /// what that process starts, is kept there as well.
  explicit OneProcessor(pid_t other);
  ~OneProcessor();
  OneProcessor(const OneProcessor&) = delete;
  OneProcessor& operator=(const OneProcessor&) = delete;

  /// Before each turn. Once in a while both are left to the system's scheduler for a turn, so that they
  /// follow where it wants them.
  void turn();

 private:
  void release();

  pid_t other_;
  pid_t thread_;
  cpu_set_t allowed_{};        ///< Processors that this thread was allowed.
  cpu_set_t allowed_other_{};  ///< Processors that the process was allowed.
  unsigned turns_{};
};

}  // namespace kerfbench::base
