// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::fold {

/// Whose path a program is.
enum class PathLaw {
  kOurs,          ///< The planner's own joints over the folds.
  kPaper,         ///< The joints of the paper's text, taken literally.
  kUncompensated  ///< The beam on the contour itself.
};

/// What the planner is asked for.
struct ProgramOrder {
  double kerf_radius_mm{};
  bool left{true};
  PathLaw law{PathLaw::kOurs};
};

/// The five-axis program that the planner writes for a contour, as `kerfplan compensate` does.
/// @throws base::InputError with the planner's reasons.
std::string plannedProgram(const std::string& contour, const std::string& name, const ProgramOrder& order);

}  // namespace kerfbench::fold
