// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "twin/cutter/description.h"
#include "twin/drive/pulse_command.h"
#include "twin/machine/multibody.h"
#include "twin/optics/scan_head.h"

namespace kerfbench::twin {

/// The axes that pulses can move.
enum class Axis : std::size_t { kGalvoX, kGalvoY, kGantryX, kGantryY, kFeed, kCount };
inline constexpr std::size_t kAxisCount = static_cast<std::size_t>(Axis::kCount);

/// Belt, gantry or mirrors with their drives: the moving part of the twin, in steps of fixed length.
class MachineModel {
 public:
  static constexpr double kStep_s = 10e-6;

  MachineModel(const MachineDescription& machine, const WebDescription& web);

  /// Commands that pulses write to.
  [[nodiscard]] PulseCommand& command(Axis axis) { return commands_[static_cast<std::size_t>(axis)]; }
  /// One step from `begin_s`; every pulse before its end must be in the commands.
  void step(double begin_s);

  /// Belt travel since t = 0, mm, its speed mm/s and its acceleration over the last step.
  [[nodiscard]] double beltTravel_mm() const;
  [[nodiscard]] double beltSpeed_mm_s() const;
  [[nodiscard]] double beltAcceleration_mm_s2() const { return belt_acceleration_mm_s2_; }
  /// Gantry position, mm; zero without a gantry.
  [[nodiscard]] Eigen::Vector2d gantry_mm() const;
  /// Where the beam meets the work plane; nullopt when it misses it.
  [[nodiscard]] std::optional<BeamSpot> spot() const;

 private:
  struct Driven {
    std::size_t joint{};
    Servo servo;
    std::optional<Axis> axis;  ///< nullopt: the line drive.
  };

  std::vector<JointDescription> joints(const MachineDescription& machine) const;
  double lineCommand_rad(double mid_s) const;

  const bool gantry_;
  const double roller_radius_mm_;
  const SpeedProfile line_;
  ScanHead head_;
  Multibody body_;
  std::array<PulseCommand, kAxisCount> commands_;
  std::vector<Driven> driven_;
  double belt_acceleration_mm_s2_{0.0};
};

}  // namespace kerfbench::twin
