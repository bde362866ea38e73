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

/// What a board has to do with the world; ns of one clock.
class BoardPorts {
 public:
  virtual ~BoardPorts() = default;
  virtual std::uint64_t now_ns() = 0;
  virtual void sleepUntil(std::uint64_t at_ns) = 0;
  /// Levels that come in on wires of sensors.
  virtual bool level(Signal sensor) = 0;
  /// A level that goes out.
  virtual void put(Signal output, bool level) = 0;
  /// Bytes that have come for the UART.
  virtual std::vector<std::uint8_t> receive() = 0;
  /// Bytes that it sends, maybe none; what does not go now goes with a later call.
  virtual void send(std::span<const std::uint8_t> bytes) = 0;
};

struct BoardOptions {
  std::uint64_t step_ns{200'000};  ///< Inputs are looked at so often.
  /// What goes out comes so much later than in the release; more than a step and what the release takes to
  /// compute one, or distances between edges are not kept. The sheet moves on meanwhile.
  std::uint64_t delay_ns{1'000'000};
  std::uint64_t run_ns{};
};

/// How well time was kept.
struct BoardPace {
  std::uint64_t strokes{};        ///< Edges that went out.
  std::uint64_t worst_late_ns{};  ///< Behind their time, delay included.
  std::uint64_t worst_step_ns{};  ///< Between two looks at the inputs.
  bool halted{};                  ///< The release ended before its time.
};

/// A release as a controller board in real time: what its pins do goes out `delay_ns` later at the same
/// distances, what comes in reaches it when it is seen.
class Board {
 public:
  /// Pins of the release by signal: outputs and inputs that are wired.
  Board(source::SignalSource& release, const SignalMap& pins, const std::vector<Signal>& wired,
        BoardPorts& ports, const BoardOptions& options);
  /// From now on, for options.run_ns.
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
  std::map<Signal, bool> inputs_;  ///< With their levels.
  source::Batch batch_;
  std::deque<Stroke> strokes_;
  std::uint64_t begin_ns_{};
  std::uint64_t looked_ns_{};
  BoardPace pace_;
};

}  // namespace kerfbench::board
