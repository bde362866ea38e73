// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <vector>

#include "hil/source/signal_source.h"
#include "twin/base/signal_map.h"

namespace kerfbench::board {

/// Connections of a board with its surroundings; ns of one clock.
class BoardPorts {
 public:
  virtual ~BoardPorts() = default;
  virtual std::uint64_t now_ns() = 0;
  virtual void sleepUntil(std::uint64_t at_ns) = 0;
  /// Level of a sensor's wire.
  virtual bool level(Signal sensor) = 0;
  /// Sets the level of an output.
  virtual void put(Signal output, bool level) = 0;
  /// Bytes that have arrived at the UART.
  virtual std::vector<std::uint8_t> receive() = 0;
  /// Sends bytes, possibly none; bytes that cannot be sent now go with a later call.
  virtual void send(std::span<const std::uint8_t> bytes) = 0;
};

struct BoardOptions {
  std::uint64_t step_ns{200'000};  ///< Interval between two readings of the inputs.
  /// Delay of the outputs behind the release; more than a step and the release's computing time for one, or
  /// distances between edges are not kept. The sheet moves on meanwhile.
  std::uint64_t delay_ns{1'000'000};
  std::uint64_t run_ns{};
};

/// Accuracy of the board's timing.
struct BoardPace {
  std::uint64_t strokes{};        ///< Number of edges put out.
  std::uint64_t worst_late_ns{};  ///< Largest lateness of an edge, beyond the delay.
  std::uint64_t worst_step_ns{};  ///< Longest interval between two readings of the inputs.
  bool halted{};                  ///< True if the release ended before its time.
};

/// A release as a controller board in real time: the release's pins appear `delay_ns` later at the same
/// distances; inputs reach the release when they are read.
class Board {
 public:
  /// Makes a board. Pins of the release by signal: outputs and inputs that are wired.
  Board(source::SignalSource& release, const SignalMap& pins, const std::vector<Signal>& wired,
        BoardPorts& ports, const BoardOptions& options);
  /// Runs for options.run_ns.
  BoardPace run();

 private:
  struct Stroke {
    std::uint64_t at_ns{};
    Signal signal{};
    bool level{};
  };
  void step(std::uint64_t now_ns);
  void lookAtInputs(Tick now);
  void putDue();
  void take(const PinEvent& event);

  source::SignalSource& release_;
  TickRate rate_;
  SignalMap pins_;
  BoardPorts& ports_;
  BoardOptions options_;
  std::map<PinId, Signal> outputs_;
  std::map<Signal, bool> inputs_;  ///< Wired inputs with their levels.
  source::Batch batch_;
  std::deque<Stroke> strokes_;
  std::uint64_t begin_ns_{};
  std::uint64_t looked_ns_{};
  BoardPace pace_;
};

}  // namespace kerfbench::board
