// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace kerfbench::planner {

/// A place of the contour or of the beam's path, with the optical axis there: a unit vector from the sheet to
/// the head.
struct SpacePoint {
  Eigen::Vector3d p_mm{Eigen::Vector3d::Zero()};
  Eigen::Vector3d axis{Eigen::Vector3d::UnitZ()};
};

/// Joints of Chi et al. 2014, 1.2.2, and the two limits in which none of them is needed.
enum class SpaceJoint {
  kPlanar,        ///< Omega = 180 ± 0.01 degrees: shortened, extended or inserted in the plane.
  kOnePoint,      ///< alpha = beta: both offsets meet the fold at one point.
  kRadius,        ///< Cases 1 and 4: over the fold at the radius from B.
  kParallel,      ///< Cases 2 and 5.
  kIntersection,  ///< Cases 3 and 6.
  kFixedLength,   ///< Cases 7 and 8.
};
const char* nameOf(SpaceJoint joint);

/// Two lines AB and BC in planes that meet in the fold MN, which goes through B.
///
/// Both offsets meet the fold on the same side of B; alpha and beta are the angles of BA and BC with the
/// other half of the fold. A line at less than 90° is offset over all of its length before its offset meets
/// the fold; one at more is not: its offset meets the fold |r cot alpha| behind B.
struct FoldCorner {
  double alpha_rad{};  ///< Angle of BA, in (0, pi).
  double beta_rad{};   ///< Angle of BC, in (0, pi).
  double omega_rad{};  ///< Free angle between the planes on the head's side; > pi at an edge that sticks out.
  [[nodiscard]] SpaceJoint joint() const;
  /// Number 1 … 8 of the paper's Table 1, which is not in the text: alpha < beta 1, 2, 3, 7 and alpha > beta
  /// 4, 5, 6, 8; both acute; one obtuse and alpha + beta < 180°; one obtuse and the sum larger; both obtuse.
  /// 0 for kOnePoint.
  [[nodiscard]] int number() const;
};

/// Path from the strict offset of AB to that of BC, in the two half planes: x along the fold on the offset's
/// side, y from the fold into the half plane, both from B.
struct FoldPath {
  double cut_first_mm{};                ///< Distance before the end B up to which AB is offset strictly.
  double cut_second_mm{};               ///< Distance after B from which on BC is offset strictly.
  std::vector<Eigen::Vector2d> first;   ///< Points from AB's offset on, without the point on the fold.
  double fold_mm{};                     ///< Coordinate x of the point on the fold.
  std::vector<Eigen::Vector2d> second;  ///< Points from BC's offset towards the fold.
  /// True if the joint as the paper draws it would come nearer than the radius to the other line, or leave
  /// the strict offset too soon. The path then leaves where the strict offset ends, and turns on tangents of
  /// the space that the beam must not enter.
  bool drawn_back{};
};

/// Computes the path by three criteria: (1) strict offset wherever it is no nearer than the radius to both
/// lines, (2) never nearer than the radius to either, measured in space, (3) one more point in each plane up
/// to Omega = 270°; above that, where the other line passes below the plane, one for each right angle that
/// the path turns round it.
///
/// The places of a half plane that are nearer than r to the other line, or to B, are a convex set: its
/// distance function is convex. So tangents lead round it, from the point where the strict offset meets it to
/// the nearest free point of the fold. With a line's direction w, a point p = r nu + s v of the other's
/// offset is nearer to it than r if p·w > s, so the strict offset ends at s = r max(0, nu·w)/(1 - v·w).
FoldPath foldPath(const FoldCorner& corner, double radius_mm);

/// Joint as in the paper's text, for comparison; empty where it cannot be formed (fixed length, if no point
/// of the other offset is at r). The points go from offset to offset over the fold, like FoldPath::first, the
/// fold point and FoldPath::second reversed.
struct PaperPath {
  double cut_first_mm{};   ///< As in FoldPath.
  double cut_second_mm{};  ///< As in FoldPath.
  std::vector<Eigen::Vector2d> first;
  double fold_mm{};
  std::vector<Eigen::Vector2d> second;
  bool exists{true};
};
PaperPath paperPath(const FoldCorner& corner, double radius_mm);

}  // namespace kerfbench::planner
