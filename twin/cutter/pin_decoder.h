// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"
#include "twin/cutter/machine_model.h"
#include "twin/description/description.h"
#include "twin/signal/edge_queue.h"
#include "twin/signal/level_tracker.h"
#include "twin/signal/pulse_decoder.h"

namespace kerfbench::twin {

/// The machine's end of the controller's wires: turns writes to ports into steps of the axes, and into gate
/// and PWM of the laser. Its memory does not grow with the length of a run.
class PinDecoder {
 public:
  PinDecoder(const MachineDescription& machine, const WebDescription& web, TickRate rate);

  /// Decodes an event; events come by tick. Steps that are certain by then go to the model's commands.
  void decode(const PinEvent& event, MachineModel& model);
  /// States that there is no event until this tick.
  void settle(Tick now, MachineModel& model);

  /// Demand by the laser's PWM; one that is not wired asks for full power always.
  [[nodiscard]] LevelTracker& pwm() { return pwm_; }
  /// Times at which the gate opened or closed, in turn; the reader removes them.
  [[nodiscard]] EdgeQueue& gateEdges() { return gate_edges_; }

 private:
  /// Port and bit of a signal. A pin that is not wired has an empty mask: it is low for ever.
  struct Wire {
    std::uint16_t port{};
    std::uint16_t mask{};
  };
  struct Input {
    Axis axis{};
    Wire pul, dir, enable;
    PulseDecoder decoder;
  };

  /// An input of the laser. Until its pin changes for the first time it is inactive, whatever its active
  /// level is: a pin that nobody drives, as in a reset, is held there by the laser's supply.
  struct LaserInput {
    Wire wire;
    bool is_low{};  ///< Active while the pin is low.
  };

  [[nodiscard]] static Wire wire(const SignalMap& map, Signal signal);
  [[nodiscard]] bool high(Wire wire) const { return (ports_[wire.port] & wire.mask) != 0; }

  TickRate rate_;
  std::vector<Input> inputs_;
  LaserInput gate_input_, pwm_input_;
  bool gate_open_{false};
  std::vector<std::uint16_t> ports_;  ///< Present levels of the ports.
  LevelTracker pwm_;
  EdgeQueue gate_edges_;
};

}  // namespace kerfbench::twin
