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
  /// Makes steps first, first + 1, …: step i is [i, i + 1] * kStep_s, and steps follow one another. Every
  /// pulse before their end must be in the commands. Many steps at once cost less than one by one, and come
  /// to the same. @throws DivergenceError with time and joint.
  void run(std::uint64_t first, std::uint64_t steps);

  // The functions below give the state at the end of the last step.

  [[nodiscard]] MachinePose pose() const;
  /// Speed of the roller's surface, as the encoder sees it; accelerations are means over the last step.
  [[nodiscard]] double rollerSpeed_mm_s() const;
  [[nodiscard]] double rollerAcceleration_mm_s2() const;
  /// Speed of the board, slip on the belt included, as the mark sensor and the beam see it.
  [[nodiscard]] double sheetSpeed_mm_s() const;
  [[nodiscard]] double sheetAcceleration_mm_s2() const;
  /// Speed of the gantry, mean over the last step.
  [[nodiscard]] Eigen::Vector2d gantrySpeed_mm_s() const;
  /// Place where the beam meets the board's surface; nullopt when it misses it.
  [[nodiscard]] std::optional<BeamSpot> spot() const;
  /// All lost steps so far, by time; by axis if within the same 10 us.
  [[nodiscard]] const std::vector<LostSteps>& lostSteps() const { return lost_; }

 private:
  /// What the accelerations, and the speed of a gantry, are told from.
  struct Before {
    double roller_mm_s{}, sheet_mm_s{};
    Eigen::Vector2d gantry_mm{Eigen::Vector2d::Zero()};
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
  void makeInputs(std::uint64_t first, std::size_t steps);
  void note();
  void watchTeeth();

  MachineMechanism machine_;
  bool gantry_;
  double roller_radius_mm_;
  double squareness_sin_, squareness_cos_;
  SpeedProfile line_;
  BeamDescription beam_;
  Surface surface_;
  std::optional<ScanHead> head_;
  std::array<PulseCommand, kAxisCount> commands_;
  Fidelity fidelity_;
  std::unique_ptr<Solver> solver_;
  double line_rad_{};  ///< Command of the line's drive at the end of the last step.
  std::vector<DriveCommand>
      inputs_;  ///< Commands of each drive for the first step of a run, then the next, …
  std::vector<ToothWatch> watches_;
  std::vector<LostSteps> lost_;
  double time_s_{0.0};
  Before before_;  ///< State before the last step.
};

}  // namespace kerfbench::twin
