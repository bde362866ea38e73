// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include "hil/vision/corner/corner_light.h"
#include "hil/vision/corner/corner_shape.h"

namespace kerfbench::vision {

/// What a leg adds to the fluence.
struct LegBeam {
  double peak{};        ///< In its middle, over the fluence that cuts through.
  double end_mm{};      ///< Along the leg, where it ends at the corner.
  double per_radius{};  ///< 1/w, 1/mm.
  double cosine{};      ///< Distance from the line over that along the nominal normal.
  double offset_mm{}, slope{}, half_curvature{}, sixth_twist{};  ///< As CornerLeg has them.

  bool operator==(const LegBeam&) const = default;
};

/// Short piece of an arc.
struct ArcPiece {
  Eigen::Vector2d p_mm{Eigen::Vector2d::Zero()};
  double share{};  ///< Fluence in its middle, over that which cuts through.

  bool operator==(const ArcPiece&) const = default;
};

/// A Gaussian beam on its way round a corner.
///
/// Fluence as KerfOutline has it: along a leg s0 exp(-2 n²/w²) erfc(sqrt(2) a/w) / 2 at n beside it and a
/// beyond its end, and s0 sqrt(2/pi)/w exp(-2 d²/w²) per length of an arc at a distance d.
struct CornerBeam {
  LegBeam in, out;
  std::vector<ArcPiece> arc;

  CornerBeam() = default;
  CornerBeam(CornerShape shape, const CornerLight& light);
};

/// Fluence of a beam at many places, over that which cuts through, and how it changes with the beam.
class CornerFluence {
 public:
  /// The nominal curves of `legs` are those of all beams to come.
  explicit CornerFluence(const CornerShape& legs) : legs_(legs) {}
  /// Adds a place, counted from the nominal corner.
  void addPlace(const Eigen::Vector2d& p_mm);

  /// Fluence at each place.
  void compute(const CornerBeam& beam, std::vector<float>& share) const;
  /// As compute(), and keeps the parts of this fluence for rateTowards().
  void linearizeAt(const CornerBeam& beam, std::vector<float>& share);
  /// Derivative of the fluence at each place by a parameter, of which a step of `step` makes `next` of the
  /// beam of linearizeAt(). Exact for a small step.
  void rateTowards(const CornerBeam& next, double step, std::vector<float>& share_rate) const;

 private:
  /// The places beside a leg, and its light there.
  struct BesideLeg {
    std::vector<float> along_mm, beside_mm;
    // At the beam of linearizeAt(): distance from the line, in radii; light, and its derivative by the
    // distance beyond the leg's end, in radii.
    std::vector<float> off, light, edge;
  };

  CornerShape legs_;
  std::vector<float> x_mm_, y_mm_;
  BesideLeg in_, out_;
  CornerBeam beam_;
  std::vector<std::vector<float>> arc_light_;  ///< Light of each piece of that beam's arc.
};

}  // namespace kerfbench::vision
