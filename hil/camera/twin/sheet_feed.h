// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>

namespace kerfbench::twin {
class Sheet;
}

namespace kerfbench::camera {

/// Pieces of web on their way from a machine that runs, on one thread, to the kerf camera, on another: one
/// for each unit from 0 on, and in the end what is left, which shows all others.
class SheetFeed {
 public:
  /// `most_waiting`: pieces that may wait to be taken, >= 1.
  explicit SheetFeed(std::size_t most_waiting) : most_waiting_(most_waiting) {}

  /// The piece with the next unit. Waits while too many wait.
  void add(std::shared_ptr<const twin::Sheet> piece);
  /// The machine has stopped: `rest` shows the units that follow.
  void end(std::shared_ptr<const twin::Sheet> rest);

  /// The piece with the next unit, for which it waits; at the end each time the rest. Null: there will be
  /// none.
  std::shared_ptr<const twin::Sheet> take();
  /// Nobody takes any more: nothing waits from now on.
  void close();

 private:
  std::mutex mutex_;
  std::condition_variable more_, taken_;
  std::deque<std::shared_ptr<const twin::Sheet>> pieces_;
  std::shared_ptr<const twin::Sheet> rest_;
  std::size_t most_waiting_;
  bool closed_{false};
};

}  // namespace kerfbench::camera
