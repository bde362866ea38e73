// SPDX-License-Identifier: Apache-2.0
#include "hil/fold/fold_program.h"

#include <vector>

#include "firmware_under_test/planner/compensation/space_file.h"
#include "firmware_under_test/planner/compensation/space_path.h"
#include "hil/base/input_error.h"

namespace kerfbench::fold {
namespace {

/// The contour itself as a path: at each corner the head turns to the next line's axis.
std::vector<planner::SpacePoint> along(const planner::SpaceContour& contour) {
  std::vector<planner::SpacePoint> path;
  for (std::size_t i = 0; i + 1 < contour.points.size(); ++i) {
    path.push_back(contour.points[i]);
    path.push_back({contour.points[i + 1].p_mm, contour.points[i].axis});
  }
  return path;
}

}  // namespace

std::string plannedProgram(const std::string& contour, const std::string& name, const ProgramOrder& order) {
  try {
    planner::SpaceContour read = planner::readSpaceContour(contour, name);
    read.side = order.left ? planner::Side::kLeft : planner::Side::kRight;
    if (order.law == PathLaw::kUncompensated) return planner::writePoses(planner::posesOf(along(read)));
    const auto law = order.law == PathLaw::kPaper ? planner::JointLaw::kPaper : planner::JointLaw::kOurs;
    return planner::writePoses(
        planner::posesOf(planner::offsetInSpace(read, order.kerf_radius_mm, {}, law).points));
  } catch (const planner::CompensationError& e) {
    throw base::InputError(e.what());
  }
}

}  // namespace kerfbench::fold
