// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

#include "tests/guest/sim_chip.h"

namespace kerfbench::guest {

/// A level that a controller puts on a line, so long after its job began.
struct Stroke {
  std::uint64_t at_ns{};
  std::uint32_t line{};
  bool level{};
  friend bool operator==(const Stroke&, const Stroke&) = default;
};

struct Played {
  std::uint64_t begin_ns{};  ///< CLOCK_MONOTONIC.
  std::uint64_t end_ns{};
  std::uint64_t worst_late_ns{};         ///< A stroke after its time.
  std::vector<std::uint64_t> pulled_ns;  ///< When each stroke went out, just before the call.
  /// Strokes in a second, as they came.
  [[nodiscard]] double rate_hz(std::size_t strokes) const {
    return 1e9 * static_cast<double>(strokes) / static_cast<double>(end_ns - begin_ns);
  }
};

struct PlayerOptions {
  /// Of SCHED_FIFO, 0 for none; above 50 strokes without a pause keep the kernel's interrupt threads from
  /// running.
  int real_time_priority{0};
  std::function<void()> before{};  ///< Called in the player's thread when somebody listens, before the job.
};

/// A controller in a thread of its own: it starts its job as soon as somebody listens to its lines.
class Player {
 public:
  /// `chip` must outlive this.
  Player(SimChip& chip, std::vector<Stroke> strokes, PlayerOptions options = {});
  /// Waits for the end of the job. @throws what went wrong in the thread.
  Played join();

 private:
  void play();

  SimChip& chip_;
  std::vector<Stroke> strokes_;
  PlayerOptions options_;
  Played played_;
  std::exception_ptr fault_;
  std::jthread thread_;
};

/// CLOCK_MONOTONIC.
std::uint64_t now_ns();
void sleepUntil_ns(std::uint64_t at_ns);
/// SCHED_FIFO for the thread of this number (0: the one that calls). @throws std::system_error.
void setRealTime(int thread, int priority);

}  // namespace kerfbench::guest
