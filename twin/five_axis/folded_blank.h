// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "twin/base/print_layout.h"
#include "twin/five_axis/five_axis_head.h"
#include "twin/sheet/sheet.h"

namespace kerfbench::twin {

/// A flat face of a blank as it stands. F is its own frame: z is the normal towards the head, x and y are
/// those of its print.
struct BlankFace {
  Eigen::Isometry3d X_WF{Eigen::Isometry3d::Identity()};
  Eigen::AlignedBox2d outline_F_mm;
  PrintLayout print;  ///< One unit; its S is F.
};

/// Where a beam meets a face.
struct FaceSpot {
  std::size_t face{};
  Footprint footprint;     ///< In F.
  double past_focus_mm{};  ///< Way of the beam from the focus to the face; < 0 before it.
};

/// Faces under a beam of the radius w(s)² = w0² (1 + (s / zR)²).
///
/// A face is thin, and the light that meets it stays there. On its plane the beam has the 1/e² ellipse S = w²
/// (I + k kᵀ / kz²), k being the axis in F (the cylinder |q|² - (k·q)² = w² cut by z = 0). A face is met
/// where the axis crosses its plane within the outline, or beside it by no more than kReach radii: then the
/// beam's flank reaches it. A face lies in the shadow of another one that the axis crosses before, deeper
/// inside than kReach radii. Faces that the beam meets more aslant than kFlattest, from behind or not at all
/// get nothing.
class FoldedBlank {
 public:
  static constexpr double kReach = 2.0;
  static constexpr double kFlattest = 0.1;  ///< Least cosine of incidence.

  FoldedBlank(std::vector<BlankFace> faces, double waist_radius_mm, double rayleigh_mm);

  /// Faces that a beam meets, in their order.
  [[nodiscard]] std::vector<FaceSpot> meet(const FiveAxisBeam& beam) const;
  [[nodiscard]] const std::vector<BlankFace>& faces() const { return faces_; }

 private:
  std::vector<BlankFace> faces_;
  double waist_radius_mm_;
  double rayleigh_mm_;
};

}  // namespace kerfbench::twin
