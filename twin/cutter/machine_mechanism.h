// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>

#include "twin/description/description.h"
#include "twin/machine/mechanism.h"

namespace kerfbench::twin {

/// The axes that pulses can move.
enum class Axis : std::size_t { kGalvoX, kGalvoY, kGantryX, kGantryY, kFeed, kCount };
inline constexpr std::size_t kAxisCount = static_cast<std::size_t>(Axis::kCount);

/// Name of an axis, e.g. "galvo_x".
const char* nameOf(Axis axis);
/// Description of an axis, whether the machine has it or not.
const AxisDescription& axisOf(const MachineDescription& machine, Axis axis);

/// A machine as a mechanism, with the indices of its parts.
///
///     floor ─ roller (turns about +Wy)  ═ belt (slides along Wx) ─ sheet x ─ sheet y      ═ elastic
///           ─ feed motor                ═ roller                            with feed pulses only
///           ─ frame x ─ frame y         ═ floor (feet)                      if there is a frame; else floor
///             frame ─ motor x  ═ mirror x,   motor y ═ mirror y             two mirrors
///             frame ─ motor x  ═ bridge x (slides along Wx)                 gantry
///                     bridge ─ motor y  ═ carriage y (slides along Wy, leaning by the squareness)
///
/// Masses of rotors and mirrors count with the body that carries them. The sheet rests on the belt by
/// friction alone, of both directions together.
struct MachineMechanism {
  MechanismDescription description;

  std::size_t roller{}, belt{}, sheet_x{}, sheet_y{};
  std::optional<std::size_t> frame_x, frame_y;
  std::optional<std::size_t> head_x, head_y;  ///< Joints of the head: mirrors, or bridge and carriage.

  struct PulseDrive {
    Axis axis{};
    double motor_per_step{};  ///< Turn of the motor for one step, rad.
    /// Motion of the load for a turn of the motor, in the unit of LostSteps: rad, or mm of a slide or the
    /// belt.
    double load_per_motor{};
    double input_delay_s{};
  };
  std::vector<PulseDrive> pulse_drives;  ///< The description's first drives, in this order.
  bool line_drive{};                     ///< True if one more drive, the last, follows the line's profile.
  double line_delay_s{};                 ///< Input delay of the line's drive.
};

/// Mechanism of a machine in its steady state at t = 0: belt and sheet at the line's speed, everything else
/// at rest, drives and couplings loaded by frictions and drags. @throws std::invalid_argument with everything
/// that makes such a mechanism impossible.
MachineMechanism mechanismOf(const MachineDescription& machine, const WebDescription& web);

}  // namespace kerfbench::twin
