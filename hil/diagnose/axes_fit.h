// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hil/dieline/geometry.h"
#include "twin/base/print_layout.h"

namespace kerfbench::diagnose {

/// An instant at which the laser shone, by the pins alone.
struct LitInstant {
  Eigen::Vector2d steps{Eigen::Vector2d::Zero()};  ///< Steps of the head's axes since power-on.
  double sheet_x_mm{};                             ///< x_W of unit 0's origin, by the encoder.
};

/// Place of the beam in W, mm, for steps of the head's axes; nullopt where it has none.
using PlaceOfSteps = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& steps)>;

/// Way of the beam for one step of an axis from where it wakes, mm: the longer of both; 0 where it has no
/// place.
double longestStep_mm(const PlaceOfSteps& place);

/// What a firmware does to both axes of its head, found by comparing where its pulses lead with the drawing.
struct AxesFit {
  bool swapped{};  ///< Pulses that belong to x go to y, and the reverse.
  /// Steps that are made for one that belongs there, along x and y; negative: backwards.
  Eigen::Vector2d factor{Eigen::Vector2d::Ones()};
  Eigen::Vector2d u_factor{Eigen::Vector2d::Zero()};  ///< Expanded uncertainty (k = 2) of each.
  double before_mm{};                                 ///< RMS distance of the path from the drawing as it is.
  double after_mm{};                                  ///< The same with the axes put right.
};

struct AxesFitOptions {
  /// Axes are looked at from this RMS distance on; the limit of a path is a good one.
  double worth_mm{0.05};
  /// What may be left of it: a cause leaves what a good path has.
  double left_mm{0.1};
  /// Also a scale that differs from 1. Not for a sheet that moves, whose following can look like one.
  bool with_scale{true};
};

/// Looks for axes that are swapped, run backwards or have another scale than the machine: the path that the
/// pulses of the lit laser describe is mapped back by each of the eight ways to turn and swap two axes, with
/// a scale for each (Besl 1992, with steps in place of coordinates), and held against the drawing. One is
/// named if it leaves less than a fifth of the distance, no other that is as plain does as well (a drawing
/// that looks the same backwards names none), in place of a scale a plain shift does not either, and the path
/// is as large as the drawing. Of several that explain it the one with factors nearest to 1 is taken.
std::optional<AxesFit> fitAxes(const std::vector<LitInstant>& path, const PlaceOfSteps& place,
                               const dieline::Dieline& dieline, const PrintLayout& print,
                               const AxesFitOptions& options);

/// Names of an axis of the head for people and in machine files.
struct AxisNames {
  std::string axis;  ///< "galvo_x"
  std::string step;  ///< Key of its step, "step_urad".
};

/// What it means and what to change, in one sentence or two:
/// "X runs backwards: invert DIR of galvo_x in the firmware (Grbl: $3), or set `galvo_x.dir_low`."
std::string sentenceOf(const AxesFit& fit, const std::array<AxisNames, 2>& names);

}  // namespace kerfbench::diagnose
