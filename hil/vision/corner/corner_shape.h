// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace kerfbench::vision {

/// One leg of a corner as cut, beside its nominal curve. Lengths count along that, from the nominal corner in
/// the origin outwards; offsets to the left of who goes outwards.
struct CornerLeg {
  Eigen::Vector2d outwards{Eigen::Vector2d::UnitX()};  ///< Unit, away from the corner.
  double bend_per_mm{};                                ///< Curvature of the nominal curve, > 0 to the left.
  double offset_mm{};         ///< Offset of the centre line where the nominal curve has its corner,
  double slope{};             ///< how it changes with the length,
  double curvature_per_mm{};  ///< its second derivative
  double twist_per_mm2{};     ///< and its third; before the corner it runs straight on.
  double over_mm{};  ///< How far the beam ran beyond where the two legs meet; < 0: it stopped short of that.

  struct Place {
    double along_mm, beside_mm;
  };
  [[nodiscard]] Place placeOf(const Eigen::Vector2d& p_mm) const;
  [[nodiscard]] double offsetAt(double along_mm) const;
  /// Point of the centre line.
  [[nodiscard]] Eigen::Vector2d at(double along_mm) const;
};

/// A corner as cut, about the nominal one in the origin.
struct CornerShape {
  CornerLeg in{.outwards = -Eigen::Vector2d::UnitX()};  ///< The beam comes along it,
  CornerLeg out{.outwards = Eigen::Vector2d::UnitY()};  ///< and leaves along this.
  double rounding_mm{};  ///< > 0: an arc that touches both legs passes so far inside of where they meet.
};

/// Path of the beam near a corner.
struct CornerPath {
  double end_in_mm{};  ///< Along the legs, where they end.
  double end_out_mm{};
  std::vector<Eigen::Vector2d> arc;  ///< Even pieces from end to end; empty without rounding.
};

/// Where both legs would meet if they ran straight on from the nominal corner. They must not be parallel.
Eigen::Vector2d vertexOf(const CornerLeg& in, const CornerLeg& out);

/// How far before the vertex an arc begins that passes so far inside of it.
double arcLegMm(double turn_rad, double rounding_mm);

/// @param pieces of the arc.
CornerPath pathOf(const CornerShape& shape, int pieces);

/// Hausdorff distance of the corner's two paths, the nominal one and that of the beam, over the legs' first
/// `reach_mm`: the farthest that any place of one lies from the other.
double deviationMm(const CornerShape& shape, double reach_mm);

}  // namespace kerfbench::vision
