// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <thread>
#include <vector>

#include "tests/guest/sim_chip.h"

namespace kerfbench::guest {

/// A level that a controller puts on a line, at a time after its job began.
struct Stroke {
  std::uint64_t at_ns{};
  std::uint32_t line{};
  bool level{};
  friend bool operator==(const Stroke&, const Stroke&) = default;
};

struct Played {
  std::uint64_t begin_ns{};  ///< Time of the begin on CLOCK_MONOTONIC.
  std::uint64_t end_ns{};
  std::uint64_t worst_late_ns{};         ///< Largest lateness of a stroke.
  std::vector<std::uint64_t> pulled_ns;  ///< Time of each stroke, just before the call.
  /// Rate of the strokes as played.
  [[nodiscard]] double rate_hz(std::size_t strokes) const {
    return 1e9 * static_cast<double>(strokes) / static_cast<double>(end_ns - begin_ns);
  }
};

struct PlayerOptions {
  /// Priority of SCHED_FIFO, 0 for none; above 50 strokes without a pause keep the kernel's interrupt threads
  /// from running.
  int real_time_priority{0};
  /// Called in the player's thread when a reader has the lines, before the job.
  std::function<void()> before{};
};

/// A controller in a thread of its own: it starts its job as soon as a reader has its lines.
class Player {
 public:
  /// Makes a player; `chip` must outlive it.
  Player(SimChip& chip, std::vector<Stroke> strokes, PlayerOptions options = {});
  /// Waits for the end of the job. @throws the exception of the thread.
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

/// Time on CLOCK_MONOTONIC.
std::uint64_t now_ns();
void sleepUntil_ns(std::uint64_t at_ns);
/// Sets SCHED_FIFO for the thread of this number (0: the calling one). @throws std::system_error.
void setRealTime(int thread, int priority);

}  // namespace kerfbench::guest
