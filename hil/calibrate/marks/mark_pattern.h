// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "hil/calibrate/marks/mark_code.h"

namespace kerfbench::calibrate {

/// A field mark: four arms that point at its centre and do not meet there, and five ticks in the quadrants
/// between them that tell its number. The measured point is where the centre lines of the two pairs of arms
/// cross, found from calipers along all four.
///
/// Frame M: origin in the centre, x along the first arm, y a quarter turn to the left. M lies in the sheet
/// turned by kMarkTurn_rad: so its arms run along neither the axes of the mirrors nor the rows of a camera,
/// and the steps of both average out along them; and its mirror image is turned the other way. With half a
/// size h = size_mm / 2, arms run from kArmFrom h to h, and the slots of the first quadrant lie at all (x, y)
/// of kSlot h; ticks are dashes along the diagonal of their quadrant, kTick h long.
///
/// Nothing crosses, nothing is closed: the sheet stays in one piece, and the beam comes nowhere twice.
inline constexpr double kMarkTurn_rad = 0.24497866312686414;  ///< atan 1/4
inline constexpr double kArmFrom = 0.2;
inline constexpr std::array kSlot{0.34, 0.62, 0.90};
inline constexpr double kTick = 0.08;
/// Kerfs up to this share of the size leave board between arms and ticks: 0.3 mm of 4.8 mm.
inline constexpr double kWidestKerf = 1.0 / 16.0;
/// Marks whose centres are this many sizes apart along Sx or Sy never touch.
inline constexpr double kMarkPitch = 1.25;
/// Farthest part of a mark from its centre, along Sx or Sy, in halves of its size.
inline constexpr double kMarkReach = 1.13;

/// A cut from rest to rest.
struct MarkStroke {
  Eigen::Vector2d from_mm{Eigen::Vector2d::Zero()};
  Eigen::Vector2d to_mm{Eigen::Vector2d::Zero()};
};

/// Centre of a slot in M for half a size of 1. @throws std::out_of_range.
Eigen::Vector2d slotCentre(int slot);

/// The four arms of a mark in the sheet's directions, from its centre, each outwards: along Mx, My, -Mx, -My.
std::array<MarkStroke, 4> markArms(double size_mm);
/// Ticks of a mark, in order of slot.
std::vector<MarkStroke> markTicks(int number, double size_mm);

}  // namespace kerfbench::calibrate
