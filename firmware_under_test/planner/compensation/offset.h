// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware_under_test/planner/compensation/contour.h"

namespace kerfbench::planner {

/// How the offsets of two neighbouring segments are joined (Chi et al. 2014, 1.1).
enum class JointKind {
  kTangent,    ///< They meet by themselves.
  kShortened,  ///< The corner opens to the beam's side: both end where they cross.
  kExtended,   ///< It turns away by no more than 90°: both run on along their tangents until they meet.
  kInserted,   ///< It turns away by more: an arc of the kerf's radius round the corner.
};
const char* nameOf(JointKind kind);

/// A joint of a contour, and what became of it.
struct Joint {
  std::size_t contour{};
  std::size_t segment{};  ///< The one that ends here.
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  double turn_rad{};  ///< -pi … pi, > 0 to the left.
  JointKind kind{JointKind::kTangent};
};

/// A stretch of contour of which the beam leaves the edge uncut, for it cannot come nearer than its radius to
/// the rest.
struct LostStretch {
  enum class Kind {
    kRounded,  ///< A corner or a curve towards the beam, turning by 150° at most: its inside is round.
    kNarrow,   ///< A slot, a gap between contours, a wedge sharper than 30°, a curve tighter than the beam.
    kWhole,    ///< The contour has no path at all.
  };
  Kind kind{Kind::kNarrow};
  std::size_t contour{};
  std::vector<int> entities;
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};  ///< Where it is deepest.
  double length_mm{};                             ///< Along the contour.
  double depth_mm{};  ///< Depth of what stays between the contour and the nearest edge of the cut; infinite:
                      ///< all.
};

/// One path of the beam's centre.
struct BeamPath {
  std::vector<Segment> segments;
  std::size_t
      contour{};  ///< Contour of its first segment: a path may run along several that lie close together.
};

struct Offset {
  std::vector<BeamPath> paths;
  std::vector<Joint> joints;
  std::vector<LostStretch> lost;
};

/// Shallower than this is the rounding of numbers, and not told.
inline constexpr double kShallowMm = 1e-3;

/// The paths of the beam's centre at `radius_mm` from the contours, on their sides.
///
/// The path is the border of the plane that the beam's centre may enter: never nearer than the radius to any
/// contour (to within 1e-5 mm), at the radius wherever that is possible, farther only at extended joints. It
/// is put together from the offset of each segment and the joints, cut where they cross, of which the parts
/// with free way beside them remain (as Held 1991 and later offset by arcs do). Closed contours act on each
/// other, so their sides must fit: outlines and holes by nesting. Each open contour is on its own.
///
/// `contours` are healed(). @throws CompensationError that lists all faults: contours that touch or cross
/// themselves or each other, and any path that does not close or comes too near after all.
Offset offsetContours(const std::vector<Contour>& contours, double radius_mm);

}  // namespace kerfbench::planner
