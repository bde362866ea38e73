// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware_under_test/planner/compensation/contour.h"

namespace kerfbench::planner {

/// Kinds of joints between the offsets of two neighbouring segments (Chi et al. 2014, 1.1).
enum class JointKind {
  kTangent,    ///< Offsets that meet without change.
  kShortened,  ///< Offsets that both end where they cross: the corner opens to the beam's side.
  /// Offsets that run on along their tangents until they meet: the corner turns away by no more than 90°.
  kExtended,
  /// Offsets that an arc of the kerf's radius joins round the corner: the corner turns away by more.
  kInserted,
};
const char* nameOf(JointKind kind);

/// A joint of a contour, and its kind of offset.
struct Joint {
  std::size_t contour{};
  std::size_t segment{};  ///< Segment that ends at the joint.
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  double turn_rad{};  ///< Turn, -pi … pi, > 0 to the left.
  JointKind kind{JointKind::kTangent};
};

/// A stretch of contour whose edge stays uncut, because the beam cannot come nearer than its radius to the
/// rest.
struct LostStretch {
  enum class Kind {
    kRounded,  ///< A corner or a curve towards the beam, turning by 150° at most: its inside is round.
    kNarrow,   ///< A slot, a gap between contours, a wedge sharper than 30°, a curve tighter than the beam.
    kWhole,    ///< The contour has no path at all.
  };
  Kind kind{Kind::kNarrow};
  std::size_t contour{};
  std::vector<int> entities;
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};  ///< Deepest place.
  double length_mm{};                             ///< Length along the contour.
  /// Depth of the uncut remainder between the contour and the nearest edge of the cut; infinite: all.
  double depth_mm{};
};

/// One path of the beam's centre.
struct BeamPath {
  std::vector<Segment> segments;
  /// Contour of its first segment: a path may run along several that lie close together.
  std::size_t contour{};
};

struct Offset {
  std::vector<BeamPath> paths;
  std::vector<Joint> joints;
  std::vector<LostStretch> lost;
};

/// Depth below which a lost stretch is a rounding error and is not reported.
inline constexpr double kShallowMm = 1e-3;

/// Offsets the contours: paths of the beam's centre at `radius_mm` from them, on their sides.
///
/// The path is the border of the region that the beam's centre may enter: never nearer than the radius to any
/// contour (to within 1e-5 mm), at the radius wherever that is possible, farther only at extended joints. It
/// is composed of the offset of each segment and the joints, cut where they cross; the parts with free space
/// along them remain (as Held 1991 and later offset by arcs do). Closed contours act on each other, so their
/// sides must fit: outlines and holes by nesting. Each open contour is independent.
///
/// `contours` are healed(). @throws CompensationError that lists all faults: contours that touch or cross
/// themselves or each other, and any path that does not close or comes too near after all.
Offset offsetContours(const std::vector<Contour>& contours, double radius_mm);

}  // namespace kerfbench::planner
