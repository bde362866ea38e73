// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "hil/inspect/evidence/evidence.h"

namespace kerfbench::inspect {

/// One frame that shows the spot on a unit whose place is known, with the place on the dieline that it
/// belongs to.
struct LitFrame {
  std::size_t frame{};  ///< Index in SpotTrack::frames.
  double time_s{};
  double sigma_mm{};  ///< Standard uncertainty of the spot on its sheet per axis: spot and sheet, noise only.
  int unit{};
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};  ///< Spot in the frame S of its unit.
  std::vector<std::size_t> marks{};                 ///< Marks of the print that told where the unit was.
  double sheet_x_mm{};                              ///< x_W of the origin of S.
  int entity{-1};       ///< -1: no entity within kReach_mm that runs the same way.
  int left_entity{-1};  ///< Line that the run of a spot off every line had followed, or came back to.
  /// The spot left that line and came back to it, and went along it all the while: beside it however far.
  bool beside{};
  double deviation_mm{};  ///< Along the left normal of either; NaN if there is none.
  double n_x{};           ///< x of that normal in W.
  double distance_mm{};   ///< Distance to the nearest entity of any kind; kSearch_mm if none is nearer.
  bool ambiguous{};       ///< Another entity that runs another way is within reach: a corner or a crossing.
};

/// A run of frames with the spot alight on one unit: each the next of the camera, or the next that is not
/// dark while the gate stays open and the spot goes straight on, no more than kDark_s or kDarkFrames later. A
/// corner that is dark parts two lines.
struct LitRun {
  std::size_t begin{};  ///< Indices into LitFrames::frames.
  std::size_t end{};
};

struct LitFrames {
  std::vector<LitFrame> frames;  ///< In order of time.
  std::vector<LitRun> runs;
  std::size_t lit{};       ///< Frames with a spot, also those below.
  std::size_t unplaced{};  ///< Spot seen, but no mark seen near enough in time to say where the sheet was.
  double period_s{};       ///< Median time between frames; NaN with fewer than two.
};

inline constexpr double kReach_mm = 0.3;   ///< Largest distance of a spot from its entity.
inline constexpr double kSearch_mm = 1.0;  ///< How far the nearest entity is looked for.
/// For so long, or for so many periods of the camera, a cut may be dark and go on as the same: frames between
/// two pulses of a laser's PWM, corners in which the beam is slow. Two parts of a cut would each show a small
/// part of how far the beam drifts; a longer darkness may be a jump with the gate open.
inline constexpr double kDark_s = 0.02;
inline constexpr double kDarkFrames = 3.5;

/// The spot burns away from every line.
inline bool isOffLine(const LitFrame& frame) { return frame.entity < 0 && frame.distance_mm > kReach_mm; }

/// Puts the spots into the frames of their units (sheet poses are interpolated over frames without marks in
/// view) and follows each run along the dieline: the sequence of entities of least cost in distance,
/// direction and changes, by dynamic programming. Nearest alone would hide a fault near a neighbour.
///
/// A spot that leaves its line by more than kReach_mm is still measured against it, as left_entity: if the
/// frames of its run before and after it, where there are any, agree on the entity, and it lies beside that,
/// not beyond an end of it. Farther off than kSearch_mm that tells where it was only if it went along that
/// line, by nine tenths of its way, from where it left it to where it came back (`beside`).
///
/// @param gates When the gate was open; in any order.
LitFrames followDieline(const vision::SpotTrack& track, const dieline::Dieline& dieline,
                        std::vector<GateInterval> gates);

}  // namespace kerfbench::inspect
