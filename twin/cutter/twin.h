// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "twin/base/pin_event.h"
#include "twin/base/signal_map.h"
#include "twin/cutter/belt_encoder.h"
#include "twin/cutter/burner.h"
#include "twin/cutter/exposure_recorder.h"
#include "twin/cutter/limit_switches.h"
#include "twin/cutter/machine_model.h"
#include "twin/cutter/pin_decoder.h"
#include "twin/cutter/power_monitor.h"
#include "twin/cutter/print_mark_sensor.h"
#include "twin/description/description.h"
#include "twin/description/fidelity.h"
#include "twin/description/machine_pose.h"
#include "twin/laser/laser.h"

namespace kerfbench::twin {

struct TwinOptions {
  Fidelity fidelity{Fidelity::kReference};
  std::uint64_t seed{1};  ///< Seed of sensor jitter and laser noise.
  /// Off: takeExposures() stays empty. For runs of hours whose frames nobody looks at.
  bool record_exposures{true};
};

/// The whole die-cutter: pins in, sensor edges out, a burnt sheet and what cameras need in the end.
/// Deterministic: the state depends on description, options, pin events and their ticks alone, neither on the
/// length of the quanta nor on predictSensors().
///
/// Memory over long runs: what is burnt (Sheet::bytes()), one entry for each lost step, and exposures until
/// they are taken (1.3 KiB for each of 200 us: 4.8 GB an hour at 1000 frames/s). Nothing else grows.
class Twin {
 public:
  /// @throws std::invalid_argument with everything that faultsOf(machine, web) finds.
  Twin(const MachineDescription& machine, const WebDescription& web, TickRate rate,
       const TwinOptions& options = {});

  /// Edges of the controller's inputs in (now, until], by tick: encoder, print mark, limits, interlock, power
  /// monitor.
  std::vector<SensorEdge> predictSensors(Tick until);
  /// Edges of the power monitor that are predicted further ahead than this may come late; infinity if nobody
  /// wired it.
  [[nodiscard]] double longestQuantum_s() const;
  /// Goes on to `until`; `events` are all pin events of the controller in (now, until], by tick.
  /// @throws DivergenceError
  void advance(Tick until, std::span<const PinEvent> events);

  /// What is burnt so far. Good until the next advance(). Where it is asked for while the beam is lit a chord
  /// ends early (see Burner): the same sheet to 1e-3 of its peak, but not to the last bit.
  [[nodiscard]] const Sheet& sheet();
  /// Exposures of the spot camera that have ended; each is handed out once.
  std::vector<Exposure> takeExposures() { return exposures_.take(); }
  /// Steppers that the load has pulled over, by time.
  [[nodiscard]] const std::vector<LostSteps>& lostSteps() const { return model_.lostSteps(); }
  /// Where everything is at the end of the last whole step.
  [[nodiscard]] MachinePose pose() const { return model_.pose(); }

  /// The model's own knowledge, for tests that measure the measurement. Nothing that judges may use it.
  struct Truth {
    double time_s{};
    double belt_travel_mm{};
    double emitted_j{};
    Eigen::Vector2d p_WQ_mm{Eigen::Vector2d::Zero()};  ///< NaN where the beam misses the board.
  };
  [[nodiscard]] Truth truth() const;

 private:
  /// Beam and web at one instant.
  struct View {
    std::optional<BeamSpot> spot;
    Eigen::Vector2d p_WS_mm{Eigen::Vector2d::Zero()};
  };
  /// What the laser emits from one share of a step to another.
  struct Emission {
    double begin{}, end{1.0};
    double energy_j{};
  };

  void stepMachine();
  void emit(double begin_s);
  void emitPart(double heard_s, double from_s, double to_s);
  const View& view();  ///< At the end of the last step.
  void openChord();
  void closeChord();
  void burnParts(const View& before, const View& after);
  void expose(const View& before, const View& after);
  [[nodiscard]] std::uint64_t wholeSteps(Tick tick) const;
  [[nodiscard]] double time_s() const { return static_cast<double>(steps_) * MachineModel::kStep_s; }
  [[nodiscard]] double now_s() const { return rate_.seconds(now_); }

  MachineDescription machine_;
  WebDescription web_;
  TickRate rate_;
  bool record_exposures_;
  bool monitor_wired_;
  Tick now_{0};
  std::uint64_t steps_{0};  ///< Steps of the machine, since t = 0.
  MachineModel model_;
  PinDecoder pins_;
  Laser laser_;
  Burner burner_;
  ExposureRecorder exposures_;

  BeltEncoder encoder_;
  PrintMarkSensor mark_sensor_;
  LimitSwitches limits_;
  PowerMonitor monitor_;
  bool predicting_{false};            ///< Somebody wants sensors.
  Eigen::Vector2d gantry_before_mm_;  ///< One step ago.

  bool gate_open_{false};            ///< As the laser hears it.
  std::vector<Emission> emissions_;  ///< Emissions of the present step.
  double emitted_j_{0.0};            ///< Since t = 0.
  View view_;
  std::uint64_t viewed_step_{~0ULL};  ///< Number of steps done when view_ was taken.
};

}  // namespace kerfbench::twin
