// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "hil/vision/kerf_scan.h"

namespace kerfbench::hil {

/// A leg of kerf beside a joint: the mean over its calipers over 1.7 mm.
struct KerfLeg {
  double offset_mm{};        ///< Along the entity's left normal, carried on to the joint.
  double offset_sigma_mm{};  ///< Standard uncertainty of that, by the calipers' noise.
  double half_width_mm{};
  double brightness{};
  double sigma_mm{};  ///< Standard uncertainty of one caliper, RMS.
};

/// Straight where its readings allow, else a parabola. From `from_mm` away from the joint on;
/// `beside_corner`: calipers near a joint too, as far as from_mm keeps clear of the other leg. nullopt where
/// fewer than two calipers saw the leg.
std::optional<KerfLeg> legAt(const EntityKerf& kerf, double station_mm, double from_mm,
                             bool beside_corner = false);

/// Offset of the kerf along the entity's left normal next to where it ends, from the half millimetre before
/// that; nullopt where fewer than three calipers tell.
std::optional<double> besideEnd(const EntityKerf& kerf, double station_mm);

}  // namespace kerfbench::hil
