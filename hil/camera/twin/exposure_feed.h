// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <mutex>
#include <optional>
#include <vector>

#include "twin/camera/camera.h"

namespace kerfbench::camera {

/// Exposures on their way from a machine that runs, on one thread, to the camera that renders them, on
/// another.
class ExposureFeed {
 public:
  /// `most_waiting`: exposures that may wait to be taken, >= 16.
  explicit ExposureFeed(std::size_t most_waiting) : most_waiting_(most_waiting) {}

  /// Exposures that follow, in order of sequence. @throws std::invalid_argument if they do not.
  void add(std::vector<twin::Exposure> exposures);
  /// Exposures that begin in [from_s, to_s] may be taken; those before from_s are dropped, those after to_s
  /// wait to be wanted. Neither time may go back. Waits while too many that may be taken are not.
  void want(double from_s, double to_s);
  /// No other will be added or wanted.
  void end();

  /// The next ones that may be taken, in order; waits for a few of them. Empty: there will be none.
  std::vector<twin::Exposure> take();
  /// Nobody takes any more: nothing waits from now on.
  void close();

 private:
  void countTakeable();

  std::mutex mutex_;
  std::condition_variable more_, taken_;
  std::deque<twin::Exposure> exposures_;
  std::optional<std::uint64_t> last_;  ///< Sequence of the last one added.
  std::size_t takeable_{0};            ///< The first so many of exposures_ are wanted.
  double to_s_{-std::numeric_limits<double>::infinity()};
  std::size_t most_waiting_;
  bool ended_{false};
  bool closed_{false};
};

}  // namespace kerfbench::camera
