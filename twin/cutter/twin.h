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
  /// Records exposures for takeExposures(). Off: none, for runs of hours whose frames nobody needs.
  bool record_exposures{true};
};

/// The whole die-cutter: pins in, sensor edges out, a burnt sheet and the cameras' scenes in the end.
/// Deterministic: the state depends on description, options, pin events and their ticks alone, neither on the
/// length of the quanta nor on predictSensors().
///
/// Memory over long runs: the burnt sheet (Sheet::bytes()) until it is parted off, one entry for each lost
/// step, and exposures until they are taken (1.3 KiB for each of 200 us: 4.8 GB an hour at 1000 frames/s).
/// Nothing else grows.
class Twin {
 public:
  /// @throws std::invalid_argument with everything that faultsOf(machine, web) finds.
  Twin(const MachineDescription& machine, const WebDescription& web, TickRate rate,
       const TwinOptions& options = {});

  /// Edges of the controller's inputs in (now, until], by tick: encoder, print mark, limits, interlock, power
  /// monitor.
  std::vector<SensorEdge> predictSensors(Tick until);
  /// Longest quantum for which no edge of the power monitor comes late; infinity if the monitor is not wired.
  [[nodiscard]] double longestQuantum_s() const;
  /// Advances to `until`; `events` are all pin events of the controller in (now, until], by tick.
  /// @throws DivergenceError
  void advance(Tick until, std::span<const PinEvent> events);

  /// Sheet as burnt so far, valid until the next advance(). A call while the beam is lit ends a chord early
  /// (see Burner): the sheet is the same to 1e-3 of its peak, but not to the last bit.
  [[nodiscard]] const Sheet& sheet();
  /// Parts off the web that lies at x >= `x_S_mm` in S of unit 0, see Sheet::part(): web that the beam cannot
  /// reach any more. Leaves what the machine goes on to burn as it is. Where the beam reaches it
  /// nevertheless, what is on the piece depends on the moment of the call, and so on the quanta: see
  /// beamOnPartedWeb().
  Sheet partWeb(double x_S_mm) { return burner_.part(x_S_mm); }
  /// Whether the beam has reached web that had been parted off.
  [[nodiscard]] bool beamOnPartedWeb() const { return burner_.sheet().beamOnPartedWeb(); }
  /// x_W of the origin of S of unit 0 at the end of the last whole step.
  [[nodiscard]] double webX_mm() const;
  /// Exposures of the spot camera that have ended; each is handed out once.
  std::vector<Exposure> takeExposures() { return exposures_.take(); }
  /// Lost steps of steppers that the load has pulled over, by time.
  [[nodiscard]] const std::vector<LostSteps>& lostSteps() const { return model_.lostSteps(); }
  /// Place of every part at the end of the last whole step.
  [[nodiscard]] MachinePose pose() const { return model_.pose(); }

  /// Truth of the model, for tests that measure the measurement. Nothing that judges may use it.
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
  /// Emission of the laser from one share of a step to another.
  struct Emission {
    double begin{}, end{1.0};
    double energy_j{};
  };

  void stepMachine();
  void runModel();  ///< Brings the moving parts, which lag behind while nobody looks, to steps_.
  void emit(double begin_s);
  void emitPart(double input_time_s, double from_s, double to_s);
  const View& view();  ///< Beam and web after steps_ steps.
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
  std::uint64_t steps_{0};  ///< Number of machine steps since t = 0.
  MachineModel model_;
  std::uint64_t model_steps_{0};  ///< Number of steps that the model has made; steps_ after each advance().
  PinDecoder pins_;
  Laser laser_;
  Burner burner_;
  ExposureRecorder exposures_;

  BeltEncoder encoder_;
  PrintMarkSensor mark_sensor_;
  LimitSwitches limits_;
  PowerMonitor monitor_;
  bool predicting_{false};  ///< True once predictSensors() was called.

  bool gate_open_{false};            ///< State of the gate as it reaches the laser, after the gate delay.
  std::vector<Emission> emissions_;  ///< Emissions of the present step.
  double emitted_j_{0.0};            ///< Energy emitted since t = 0.
  View view_;
  std::uint64_t viewed_step_{~0ULL};  ///< Number of steps done when view_ was taken.
};

}  // namespace kerfbench::twin
