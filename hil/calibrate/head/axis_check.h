// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include <Eigen/Core>

#include "hil/calibrate/head/observation.h"

namespace kerfbench::hil {

/// One of the eight ways in which two axes can be wired: what the head makes of a command (x, y) is (x, y),
/// or (y, x) if exchanged, and then either of its axes may run backwards.
struct AxisMap {
  bool exchanged{};
  bool x_backwards{};  ///< Of what the head makes of it, not of the command.
  bool y_backwards{};

  [[nodiscard]] bool asTold() const { return !exchanged && !x_backwards && !y_backwards; }
  [[nodiscard]] Eigen::Matrix2d matrix() const;  ///< Made = matrix · commanded.
  /// "x and y are exchanged; y runs backwards: the picture is turned by 90 degrees clockwise".
  [[nodiscard]] std::string words() const;

  friend bool operator==(const AxisMap&, const AxisMap&) = default;
};

struct AxisFinding {
  AxisMap map;
  double miss_mm{};       ///< Median distance of the marks from where this map, shifted, puts them.
  double next_miss_mm{};  ///< Of the best of the other seven.
};

/// Which of the eight it is, from pairs of aim and place. The median does not ask less than half of the
/// marks, so false ones do not matter; the head's own distortion is small against a wrong map.
/// @throws HeadCalibrationError for fewer than five marks, marks all in a line, or if none of the eight puts
///   the median mark within a fifth of the marks' spread, or two do nearly as well: marks of another job, a
///   wrong board, two fields mixed.
AxisFinding identifyAxes(std::span<const HeadObservation> observations);

}  // namespace kerfbench::hil
