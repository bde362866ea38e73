// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "twin/cutter/machine_mechanism.h"
#include "twin/description/description.h"
#include "twin/description/fidelity.h"
#include "twin/description/machine_pose.h"
#include "twin/drive/pulse_command.h"
#include "twin/drive/speed_profile.h"
#include "twin/machine/solver.h"
#include "twin/optics/scan_head.h"
#include "twin/optics/surface.h"

namespace kerfbench::twin {

/// The moving part of the twin: conveyor, frame, gantry or mirrors with their drives, in steps of fixed
/// length. A pulse acts through the area mean of its input over a step.
class MachineModel {
 public:
  static constexpr double kStep_s = 10e-6;

  /// Puts the machine together. @throws std::invalid_argument for an impossible machine, or one too fast for
  /// the step.
  MachineModel(const MachineDescription& machine, const WebDescription& web,
               Fidelity fidelity = Fidelity::kReference);

  /// Command that an axis's pulses write to.
  [[nodiscard]] PulseCommand& command(Axis axis) { return commands_[static_cast<std::size_t>(axis)]; }
  /// Makes one step from `begin_s`, the end of the last; every pulse before its end must be in the commands.
  /// @throws DivergenceError with time and joint.
  void step(double begin_s);

  // The functions below give the state at the end of the last step.

  [[nodiscard]] MachinePose pose() const;
  /// Speed of the roller's surface, as the encoder sees it; accelerations are means over the last step.
  [[nodiscard]] double rollerSpeed_mm_s() const { return roller_.speed_mm_s; }
  [[nodiscard]] double rollerAcceleration_mm_s2() const { return roller_.acceleration_mm_s2; }
  /// Speed of the board, slip on the belt included, as the mark sensor and the beam see it.
  [[nodiscard]] double sheetSpeed_mm_s() const { return sheet_.speed_mm_s; }
  [[nodiscard]] double sheetAcceleration_mm_s2() const { return sheet_.acceleration_mm_s2; }
  /// Place where the beam meets the board's surface; nullopt when it misses it.
  [[nodiscard]] std::optional<BeamSpot> spot() const;
  /// All lost steps so far, by time; by axis if within the same 10 us.
  [[nodiscard]] const std::vector<LostSteps>& lostSteps() const { return lost_; }

 private:
  struct Motion {
    double speed_mm_s{};
    double acceleration_mm_s2{};
    void follow(double speed_now_mm_s);
  };
  /// Tooth of a stepper's rotor, relative to the one it began with.
  struct ToothWatch {
    std::size_t drive{};  ///< Index of the drive in the mechanism, and in machine_.pulse_drives.
    std::size_t joint{};
    double pitch_rad{};
    double offset_rad{};  ///< Offset that is added to the drive's command.
    long long behind{};
  };

  [[nodiscard]] double lineCommand_rad(double time_s) const;
  void watchTeeth();
  void followMotion();

  MachineMechanism machine_;
  bool gantry_;
  double roller_radius_mm_;
  double squareness_sin_, squareness_cos_;
  SpeedProfile line_;
  BeamDescription beam_;
  Surface surface_;
  std::optional<ScanHead> head_;
  std::array<PulseCommand, kAxisCount> commands_;
  std::unique_ptr<Solver> solver_;
  std::vector<DriveCommand> inputs_;
  std::vector<ToothWatch> watches_;
  std::vector<LostSteps> lost_;
  double time_s_{0.0};
  Motion roller_, sheet_;
};

}  // namespace kerfbench::twin
