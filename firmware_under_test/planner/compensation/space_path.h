// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "firmware_under_test/planner/compensation/contour.h"
#include "firmware_under_test/planner/compensation/space_joint.h"

namespace kerfbench::planner {

/// A curve of a contour, given by its chords.
struct SpaceCurve {
  int file_line{};
  std::size_t first_point{};  ///< Point of the contour at which the first chord begins.
  std::size_t chords{};
  double error_mm{};  ///< Bound of the distance of the curve from its chords.
};

/// Lines in space, one after the other. The axis of a point belongs to the line that begins there; the axis
/// of the last point is not used. A polyline whose last point is its first is closed.
struct SpaceContour {
  std::vector<SpacePoint> points;
  std::vector<int> file_lines;     ///< Lines of the points, for messages; may be empty.
  std::vector<SpaceCurve> curves;  ///< Curves among the lines, in their order.
  Side side{Side::kLeft};          ///< Side of the beam, seen from the head.
  /// Curve of which the line that begins at a point is a chord, or nullptr.
  [[nodiscard]] const SpaceCurve* curveOf(std::size_t point) const;
};

struct SpaceLimits {
  double narrowest_deg{90.0};  ///< Smallest free angle that leaves room for the head.
  double planar_deg{0.01};     ///< Deviation from 180° within which two planes are one.
  /// Difference to 360° within which the beam pierces the second plane while it cuts in the first. [The paper
  /// names the limit and gives no figure.]
  double pierced_deg{10.0};
  /// Largest deviation of an axis from the right angle to its line; the axis is corrected.
  double askew_deg{0.5};
};

/// Whose joints lead over a fold: those of foldPath(), which keep all three criteria, or the four of the
/// paper's text taken literally (paperPath()), which protect B alone and may burn the second line.
enum class JointLaw { kOurs, kPaper };

/// A joint as it was made.
struct SpaceJointReport {
  std::size_t point{};             ///< Point B of the contour.
  std::size_t first_path_point{};  ///< Index of the joint's first point in SpacePath::points.
  std::size_t path_points{};       ///< Number of its points there.
  SpaceJoint joint{SpaceJoint::kPlanar};
  FoldCorner corner;
  int number{};
  bool drawn_back{};
};

struct SpacePath {
  /// Corners of the beam's path. A place on a fold comes twice, with the axis of each plane: there the head
  /// turns.
  std::vector<SpacePoint> points;
  std::vector<SpaceJointReport> joints;
  /// Places where a path by JointLaw::kPaper comes nearer than the radius to the contour.
  std::vector<std::string> burns;
};

/// Path of the beam at `radius_mm` from the contour, on its side, each line offset in the plane that its axis
/// stands upon (Chi et al. 2014). @throws CompensationError that lists every place with its reason: free
/// angles beyond the limits, axes that are no unit vectors, askew or on the other face, lines along a fold,
/// of no length or too short for their joints, a line that turns back, and a path that comes nearer than the
/// radius to any other line. By JointLaw::kPaper the latter is no error but noted in SpacePath::burns, and a
/// joint that the paper's text gives no points for is one.
SpacePath offsetInSpace(const SpaceContour& contour, double radius_mm, const SpaceLimits& limits = {},
                        JointLaw law = JointLaw::kOurs);

/// Least distance of two line segments.
double distanceMm(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                  const Eigen::Vector3d& b1);

}  // namespace kerfbench::planner
