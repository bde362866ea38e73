// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/target.h"

namespace kerfbench::planner {

/// Requirements of an axis's drive on PUL and DIR, as in its data sheet; all zero: none.
struct DriveNeeds {
  std::string name{};
  bool falling_edge{};  ///< True if PUL steps with its falling edge, and is low while active.
  bool dir_low{};       ///< True if DIR is low for the positive direction.
  double setup_s{};     ///< Shortest time that DIR is stable before the active edge.
  double hold_s{};      ///< Shortest time that DIR is stable after the active edge.
  double width_s{};     ///< Shortest time of PUL active.
  double space_s{};     ///< Shortest time of PUL idle.
};

inline constexpr std::size_t kAxes = 5;
/// Drives in the order of the protocol.
using Drives = std::array<DriveNeeds, kAxes>;

/// Settings of the controller's pulses that meet the requirements of every drive (protocol.h, KB_CONFIG).
///
/// A pulse falls within its tick, or stays for whole ticks, the same number for all axes that need it. m
/// steps in a period of T ticks come T/m ticks apart, the first T/2m ticks after the period's border and the
/// last as much before the next, where DIR changes; so fewer steps leave more time. A tick may be late.
struct PulseSettings {
  std::uint8_t invert_a{}, invert_c{};
  std::uint8_t wide{};  ///< Mask of the axes with wide pulses.
  std::uint8_t wide_ticks{};
  std::array<std::uint8_t, kAxes> most_steps{};  ///< Most steps in a period.
  std::array<std::uint8_t, kAxes> turn_steps{};  ///< Most steps in a period before or after a change of DIR.
};

/// Settings for these drives. @pre driveFaults() is empty.
PulseSettings pulsesFor(const Target& target, const Drives& drives);
/// Describes the drives that this controller cannot serve, one sentence each, with their requirement and what
/// they would get.
std::vector<std::string> driveFaults(const Target& target, const Drives& drives);

}  // namespace kerfbench::planner
