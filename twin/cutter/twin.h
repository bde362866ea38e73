// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/pulse_timing.h"
#include "twin/base/signal_map.h"
#include "twin/cutter/description.h"
#include "twin/cutter/machine_model.h"
#include "twin/cutter/sensors.h"
#include "twin/laser/laser.h"
#include "twin/signal/level_tracker.h"
#include "twin/signal/pulse_decoder.h"

namespace kerfbench::twin {

/// The whole die-cutter: pins in, sensor edges out, a burnt sheet and what cameras need in the end.
/// Deterministic: the state depends on the pin events and their ticks alone, neither on the length of the
/// quanta nor on predictSensors().
class Twin {
 public:
  /// @throws std::invalid_argument for a description that no machine can have.
  Twin(const MachineDescription& machine, const WebDescription& web, TickRate rate);

  /// Edges of the controller's inputs in (now, until], by tick: encoder, print mark, limits, interlock.
  std::vector<SensorEdge> predictSensors(Tick until);
  /// Goes on to `until`; `events` are all pin events of the controller in (now, until], by tick.
  void advance(Tick until, std::span<const PinEvent> events);

  [[nodiscard]] const Sheet& sheet() const { return sheet_; }
  [[nodiscard]] std::vector<PulseTiming> pulseTiming() const;
  /// When the laser gate was open, s.
  [[nodiscard]] std::vector<std::pair<double, double>> gateIntervals() const;
  /// Exposures of the spot camera that have ended; each is handed out once.
  std::vector<Exposure> takeExposures();

  /// The model's own knowledge, for tests that measure the measurement. Nothing that judges may use it.
  struct Truth {
    double time_s{};
    double belt_travel_mm{};
    double emitted_j{};
    Eigen::Vector2d p_WQ_mm{Eigen::Vector2d::Zero()};
  };
  [[nodiscard]] Truth truth() const;

 private:
  struct Input {
    Axis axis{};
    PinId pul, dir;
    PulseDecoder decoder;
  };

  void decode(const PinEvent& event);
  void stepMachine();
  void expose(const Eigen::Vector2d& p_WQ_mm, double radius_mm, double energy_j, double web_x_mm);
  [[nodiscard]] bool pinLevel(PinId pin) const;
  [[nodiscard]] double now_s() const { return rate_.seconds(now_); }

  MachineDescription machine_;
  WebDescription web_;
  TickRate rate_;
  Tick now_{0};
  std::uint64_t steps_{0};  ///< Of the machine, since t = 0.
  MachineModel model_;
  BeltSensors sensors_;
  bool sensors_started_{false};
  std::array<bool, 2> limits_{};
  Laser laser_;
  Sheet sheet_;
  std::vector<Input> inputs_;
  std::vector<std::uint16_t> ports_;  ///< Levels now.
  LevelTracker gate_;
  LevelTracker beam_;  ///< Gate and PWM both high.
  double emitted_j_{0.0};
  std::uint64_t frame_{0};
  Exposure exposure_;
  std::vector<Exposure> exposures_;
};

}  // namespace kerfbench::twin
