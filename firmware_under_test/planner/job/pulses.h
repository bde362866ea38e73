// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware_under_test/planner/job/target.h"

namespace kerfbench::planner {

/// What an axis's drive asks of PUL and DIR, as its data sheet says; all zero: nothing.
struct DriveNeeds {
  std::string name{};
  bool falling_edge{};  ///< PUL steps with its falling edge, and is low while active.
  bool dir_low{};       ///< DIR is low for the positive direction.
  double setup_s{};     ///< DIR stable before the active edge.
  double hold_s{};      ///< DIR stable after it.
  double width_s{};     ///< PUL active.
  double space_s{};     ///< PUL idle.
};

inline constexpr std::size_t kAxes = 5;
/// In the order of the protocol.
using Drives = std::array<DriveNeeds, kAxes>;

/// How the controller must make its pulses so that every drive gets what it needs (protocol.h, KB_CONFIG).
///
/// A pulse falls within its tick, or stays for whole ticks, the same number for all axes that need it. m
/// steps in a period of T ticks come T/m ticks apart, the first T/2m ticks after the period's border and the
/// last as much before the next, where DIR changes; so fewer steps leave more time. A tick may be late.
struct PulseSettings {
  std::uint8_t invert_a{}, invert_c{};
  std::uint8_t wide{};  ///< Mask of axes.
  std::uint8_t wide_ticks{};
  std::array<std::uint8_t, kAxes> most_steps{};  ///< In a period.
  std::array<std::uint8_t, kAxes> turn_steps{};  ///< In a period before or after a change of DIR.
};

/// @pre drivesFaults() is empty.
PulseSettings pulsesFor(const Target& target, const Drives& drives);
/// Drives that this controller cannot serve, one sentence each, with what they need and what they would get.
std::vector<std::string> driveFaults(const Target& target, const Drives& drives);

}  // namespace kerfbench::planner
