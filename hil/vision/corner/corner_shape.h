// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace kerfbench::vision {

/// Leg of a corner as cut, against its nominal curve. Lengths count along that curve outwards from the
/// nominal corner in the origin; offsets are to the left in this direction.
struct CornerLeg {
  Eigen::Vector2d outwards{Eigen::Vector2d::UnitX()};  ///< Unit, away from the corner.
  double bend_per_mm{};                                ///< Curvature of the nominal curve, > 0 to the left.
  double offset_mm{};                                  ///< Offset of the centre line at the nominal corner.
  double slope{};                                      ///< Derivative of the offset by the length, there.
  double curvature_per_mm{};                           ///< Second derivative of the offset.
  double twist_per_mm2{};  ///< Third derivative of the offset; before the corner the line runs straight on.
  double over_mm{};        ///< Overrun of the beam beyond where the two legs meet; < 0: it stopped short.

  struct Place {
    double along_mm, beside_mm;
  };
  [[nodiscard]] Place placeOf(const Eigen::Vector2d& p_mm) const;
  [[nodiscard]] double offsetAt(double along_mm) const;
  /// Point of the centre line.
  [[nodiscard]] Eigen::Vector2d at(double along_mm) const;
};

/// Corner as cut, about the nominal one in the origin.
struct CornerShape {
  CornerLeg in{.outwards = -Eigen::Vector2d::UnitX()};  ///< Leg along which the beam comes.
  CornerLeg out{.outwards = Eigen::Vector2d::UnitY()};  ///< Leg along which the beam leaves.
  double rounding_mm{};  ///< Distance of an arc that touches both legs from where they meet; 0: none.
};

/// Path of the beam near a corner.
struct CornerPath {
  double end_in_mm{};  ///< Along the legs, where they end.
  double end_out_mm{};
  std::vector<Eigen::Vector2d> arc;  ///< Even pieces from end to end; empty without rounding.
};

/// Point where both legs would meet if they ran straight on from the nominal corner. They must not be
/// parallel.
Eigen::Vector2d vertexOf(const CornerLeg& in, const CornerLeg& out);

/// Distance from the vertex at which an arc begins that passes `rounding_mm` inside of it.
double arcLegMm(double turn_rad, double rounding_mm);

/// Path with an arc of so many pieces.
CornerPath pathOf(const CornerShape& shape, int pieces);

/// Hausdorff distance of the corner's two paths, the nominal one and that of the beam, over the legs' first
/// `reach_mm`: the farthest that any place of one lies from the other.
double deviationMm(const CornerShape& shape, double reach_mm);

}  // namespace kerfbench::vision
