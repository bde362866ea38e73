// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::vision {

/// Kerf along one leg of a joint: the mean over its calipers over 1.7 mm.
struct KerfLeg {
  double offset_mm{};  ///< Along the entity's left normal, carried on straight to the joint.
  double half_width_mm{};
  double flicker_mm{};  ///< Variation of half the width along the leg, beyond what noise explains.
  double brightness{};
  double sigma_mm{};  ///< Standard uncertainty of one caliper, RMS.
};

/// Calipers from which a leg is told.
inline constexpr int kFewestOnLeg = 2;

/// Leg from `from_mm` away from the joint on; nullopt where fewer than kFewestOnLeg calipers saw it.
std::optional<KerfLeg> legAt(const EntityKerf& kerf, double station_mm, double from_mm);

/// Kerf as a caliper near a joint saw it.
struct LegReading {
  double away_mm{};    ///< Distance from the joint along the curve.
  double offset_mm{};  ///< Offset along the entity's left normal.
  double sigma_mm{};   ///< Standard uncertainty.
};

/// The calipers between `from_mm` and `to_mm` away from the joint that no joint disturbs, in order of
/// station.
std::vector<LegReading> readingsBeside(const EntityKerf& kerf, double station_mm, double from_mm,
                                       double to_mm);

/// Coefficients of a polynomial through readings, the constant first: offset over the distance from the
/// joint.
Eigen::VectorXd polynomialThrough(const std::vector<LegReading>& readings, Eigen::Index degree);

/// A straight line along a kerf near its end.
struct EndLine {
  double offset_mm{};  ///< Offset at the end, along the entity's left normal.
  double slope{};      ///< Change of the offset with the distance from the end.
};

/// Line through the half millimetre before the end; nullopt where fewer than three calipers saw the kerf.
std::optional<EndLine> besideEnd(const EntityKerf& kerf, double station_mm);

}  // namespace kerfbench::vision
