// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "hil/vision/kerf/kerf_measurement.h"

namespace kerfbench::vision {

/// A leg of kerf beside a joint: the mean over its calipers over 1.7 mm.
struct KerfLeg {
  double offset_mm{};  ///< Along the entity's left normal, carried on straight to the joint.
  double half_width_mm{};
  double flicker_mm{};  ///< By which half the width varies along the leg, beyond what noise explains.
  double brightness{};
  double sigma_mm{};  ///< Standard uncertainty of one caliper, RMS.
};

/// From `from_mm` away from the joint on. nullopt where fewer than two calipers saw the leg.
std::optional<KerfLeg> legAt(const EntityKerf& kerf, double station_mm, double from_mm);

/// Where a caliper beside a joint saw the kerf.
struct LegReading {
  double away_mm{};    ///< From the joint, along the curve.
  double offset_mm{};  ///< Along the entity's left normal.
  double sigma_mm{};   ///< Standard uncertainty.
};

/// The calipers between `from_mm` and `to_mm` away from the joint that no joint disturbs, in order of
/// station.
std::vector<LegReading> readingsBeside(const EntityKerf& kerf, double station_mm, double from_mm,
                                       double to_mm);

/// Coefficients of a polynomial through readings, the constant first: offset over the way from the joint.
Eigen::VectorXd polynomialThrough(const std::vector<LegReading>& readings, Eigen::Index degree);

/// A straight line along a kerf near its end.
struct EndLine {
  double offset_mm{};  ///< At the end, along the entity's left normal.
  double slope{};      ///< How it changes with the way from the end.
};

/// From the half millimetre before the end; nullopt where fewer than three calipers tell.
std::optional<EndLine> besideEnd(const EntityKerf& kerf, double station_mm);

}  // namespace kerfbench::vision
