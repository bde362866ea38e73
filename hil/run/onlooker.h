// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "twin/base/image.h"
#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"
#include "twin/description/machine_pose.h"

namespace kerfbench::run {

/// What happened in (from, until]. Spans are valid during the call.
struct Quantum {
  Tick from{}, until{};
  std::span<const PinEvent> events;     ///< Edges of the controller, by tick.
  std::span<const SensorEdge> sensors;  ///< Edges of its inputs, by tick; none of a recording.
  std::span<const std::uint8_t> heard;  ///< Heard on the controller's UART.
  std::span<const std::uint8_t> said;   ///< Sent to its UART.
};

/// Where the model had the machine at one instant.
struct MachineState {
  twin::MachinePose pose;
  Eigen::Vector2d spot_W_mm{Eigen::Vector2d::Zero()};  ///< NaN: the beam misses the board.
  double emitted_j{};                                  ///< Energy of the laser since t = 0.
};

/// Somebody who is shown a run while it goes on: for people, and never for what judges. The run is the same
/// with and without.
class Onlooker {
 public:
  virtual ~Onlooker() = default;
  /// Once, before anything moves.
  virtual void begins(const MachineState& state, TickRate rate) = 0;
  /// Each quantum, with the state at its end.
  virtual void saw(const Quantum& quantum, const MachineState& state) = 0;
  /// Each frame of the spot camera that is measured, in order, whole or by windows; on a thread of its own,
  /// also during the run. The model's frames are the same at any number of threads.
  virtual void sawFrame(const Frame& frame) = 0;
};

}  // namespace kerfbench::run
