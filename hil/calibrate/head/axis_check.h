// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <Eigen/Core>

#include "hil/calibrate/head/observation.h"

namespace kerfbench::calibrate {

/// One of the eight ways in which two axes can be wired: what the head makes of a command (x, y) is (x, y),
/// or (y, x) if exchanged, and then either of its axes may run backwards.
struct AxisMap {
  bool exchanged{};
  bool x_backwards{};  ///< Direction of what the head makes of it, not of the command.
  bool y_backwards{};

  [[nodiscard]] bool asTold() const { return !exchanged && !x_backwards && !y_backwards; }
  [[nodiscard]] Eigen::Matrix2d matrix() const;  ///< Made = matrix · commanded.
  /// "x and y are exchanged; y runs backwards: the picture is turned by 90 degrees clockwise".
  [[nodiscard]] std::string words() const;

  friend bool operator==(const AxisMap&, const AxisMap&) = default;
};

struct AxisFinding {
  AxisMap map;
  std::size_t
      agreeing{};  ///< Marks within a fifth of the pattern's spread of where this map, shifted, puts them.
  std::size_t next_agreeing{};  ///< Marks that agree with the best of the other seven maps.
  double miss_mm{};             ///< Median distance of the marks from where the shifted map puts them.
};

/// Finds the map of the eight that most marks agree with, from pairs of aim and place. False marks do not
/// matter, and the head's own distortion is small against a wrong map.
/// @throws HeadCalibrationError for fewer than five marks, marks all in a line, or if no more than half of
/// the
///   marks agree with any of the eight, or not clearly more with one than with another: marks of another job,
///   a wrong board, two fields mixed.
AxisFinding identifyAxes(std::span<const HeadObservation> observations);

}  // namespace kerfbench::calibrate
