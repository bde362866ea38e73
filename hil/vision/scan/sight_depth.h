// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "hil/dieline/process.h"

namespace kerfbench::vision {

/// Kerfs that are seen alike: what is cut through, and what is not.
enum class KerfForm : std::size_t { kThrough, kShallow };
inline constexpr std::size_t kKerfForms = 2;
KerfForm formOf(dieline::Process process);

/// Depth below the printed face at which the middle of a kerf is seen.
struct SightDepth {
  double mm{};
  double sigma_mm{};  ///< Standard uncertainty.
  /// How deep it may be: what an unknown lean of the camera does to a place grows with it.
  [[nodiscard]] double deepest_mm() const { return mm + sigma_mm; }
};
using SightDepths = std::array<SightDepth, kKerfForms>;  ///< One for each KerfForm.

/// What geometry alone tells of board of this thickness. A kerf is a slit with walls. Seen aslant, its middle
/// lies at half of the thickness if the walls are upright; at the bottom if the kerf narrows downwards by
/// more than the angle of sight, as laser cuts often do; anywhere between else. A groove that is not through
/// ends higher up.
SightDepths expectedDepths(double thickness_mm);

/// The same place of a kerf in two overlapping tiles.
struct SightPair {
  KerfForm form{};
  std::size_t tile{}, other{};                       ///< Indices of the tiles.
  Eigen::Vector2d normal{Eigen::Vector2d::UnitX()};  ///< Left normal of the dieline, on the table.
  double slope{};     ///< Along the normal: CameraCalibration::sightSlope in `other` less that in `tile`.
  double apart_mm{};  ///< Offset in `other` less that in `tile`, both read in the plane of the marks.
  double sigma_mm{};  ///< Standard uncertainty of apart_mm by the noise of the pixels.
};

struct SightFit {
  SightDepths depths;
  double misfit_mm{};  ///< RMS per axis of the tiles' shifts against each other; NaN without pairs.
};

/// Depths from the overlaps: a kerf that is seen at the depth d lies d · slope farther in the one tile than
/// in the other, whatever its walls are like. Least squares over the depths, with expectedDepths() as what is
/// known before, and a shift of each tile, of standard deviation table_sigma_mm; pairs that do not fit with
/// the others are left out.
SightFit sightDepths(const std::vector<SightPair>& pairs, std::size_t tiles, double thickness_mm,
                     double table_sigma_mm);

}  // namespace kerfbench::vision
