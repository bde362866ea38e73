// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kerfbench::hil {

/// Where the edge of a kerf runs whose beam did exactly what was asked, around a point where its way ends or
/// turns: how far the outline reaches beyond where the beam stopped.
///
/// beam_radius_mm = 0: a round tool as wide as the kerf; it reaches half a width beyond its stop. Otherwise a
/// Gaussian beam of that 1/e² radius w: board is gone from a share t of the fluence at the middle of a line
/// on, and the half width h that was measured tells t = exp(-2 h² / w²). At a point a along and n beside a
/// way that comes from afar and ends at a = 0 the share is exp(-2 n² / w²) erfc(sqrt(2) a / w) / 2.
struct KerfOutline {
  double half_width_mm{};
  double beam_radius_mm{};

  /// Share of the fluence in the middle of a long line, at p from where a way along `tangent` ends.
  [[nodiscard]] double shareAtEnd(const Eigen::Vector2d& p_mm, const Eigen::Vector2d& tangent) const;

  /// Mean reach of the outline along `direction` from the end of a way that came along tangent_in, over a
  /// strip of half width `strip_mm`. With a way on along tangent_out, from the corner of both.
  [[nodiscard]] double reachMm(const Eigen::Vector2d& direction, double strip_mm,
                               const Eigen::Vector2d& tangent_in,
                               const Eigen::Vector2d* tangent_out = nullptr) const;

 private:
  [[nodiscard]] bool isCut(const Eigen::Vector2d& p_mm, const Eigen::Vector2d& tangent_in,
                           const Eigen::Vector2d* tangent_out) const;
};

}  // namespace kerfbench::hil
