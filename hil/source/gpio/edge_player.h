// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

#include "hil/source/gpio/output_lines.h"
#include "hil/source/gpio/system.h"

namespace kerfbench::source {

/// An edge on an output line: when it was to be, and when the kernel had made it. ns of CLOCK_MONOTONIC.
struct PlayedEdge {
  std::size_t line{};
  bool level{};
  std::uint64_t planned_ns{};
  std::uint64_t put_ns{};  ///< Time at which the call came back: never before the edge. Ascends.
};

/// Puts edges onto output lines when their time has come, never before. Whoever owns it calls play() as often
/// as nextDue_ns() asks for; what is late then is put out at once, each edge for itself, in order.
class EdgePlayer {
 public:
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  EdgePlayer(std::shared_ptr<GpioSystem> system, OutputLines lines);

  /// Edges of one line come in the order in which they are planned, whatever their times.
  void plan(std::size_t line, bool level, std::uint64_t at_ns);
  /// Puts out what is due, and appends what it has put out. @throws GpioError as OutputLines::set().
  void play(std::vector<PlayedEdge>& played);
  /// Time at which the next edge is due; kNever: none is planned.
  [[nodiscard]] std::uint64_t nextDue_ns() const {
    return planned_.empty() ? kNever : planned_.front().due_ns;
  }

 private:
  struct Planned {
    std::uint64_t due_ns{};
    std::uint64_t wished_ns{};  ///< Planned time; before `due_ns` where the line's last edge is later.
    std::size_t line{};
    bool level{};
  };

  std::shared_ptr<GpioSystem> system_;
  OutputLines lines_;
  std::deque<Planned> planned_;          ///< Edges that are planned, by `due_ns`.
  std::vector<std::uint64_t> last_due_;  ///< Time of the last planned edge of each line.
  std::uint64_t last_put_ns_{};
};

}  // namespace kerfbench::source
