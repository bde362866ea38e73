// SPDX-License-Identifier: Apache-2.0
// How far the board is severed, from how wide the light comes through.
#include <algorithm>
#include <cmath>

#include "hil/inspect/edges/edges.h"

namespace kerfbench::inspect::checks {
namespace {

/// Standard uncertainties, as shares: of the beam's radius where the board is, of the depth at which half of
/// the light comes through (the board's transmission), and of how depth goes with fluence.
constexpr double kRadiusU = 0.05;
constexpr double kTransmissionU = 0.05;
constexpr double kLawU = 0.15;

/// ln(F_through / F_half): how much less fluence than severs the board lets half of the light through, by
/// Beer's law over the board that is left and depth in proportion to fluence.
double logFluence(double transmission) {
  const double half = 0.5 * (1.0 + transmission);  // Halfway from whole board to an open kerf.
  return -std::log(1.0 - std::log(half) / std::log(transmission));
}

/// The severed half width and what is not known of it, for all cuts alike.
struct Severed {
  double half_mm{};
  double per_half{};  ///< Change of half_mm with the half width by the light.
  double common_sigma_mm{};
};

Severed severedOf(double half_mm, double beam_radius_mm, double transmission) {
  const double log_fluence = logFluence(transmission);
  const double square_mm2 = half_mm * half_mm - 0.5 * beam_radius_mm * beam_radius_mm * log_fluence;
  if (!(square_mm2 > 0.0)) return {0.0, 0.0, half_mm};
  const double severed_mm = std::sqrt(square_mm2);
  const double lost_mm = (half_mm * half_mm - square_mm2) / (2.0 * severed_mm);
  const double by_transmission =
      std::abs(logFluence(transmission * (1.0 + kTransmissionU)) - log_fluence) / log_fluence;
  return {severed_mm, half_mm / severed_mm, lost_mm * std::hypot(2.0 * kRadiusU, by_transmission, kLawU)};
}

}  // namespace

vision::KerfScan severedScan(const vision::KerfScan& scan, const EdgeSides& sides, double beam_radius_mm,
                             double transmission) {
  vision::KerfScan severed = scan;
  for (vision::EntityKerf& kerf : severed.entities) {
    if (sides.side[static_cast<std::size_t>(kerf.entity)] == 0) continue;
    double common_mm = 0.0;
    for (vision::Caliper& c : kerf.calipers) {
      if (!c.found || !std::isfinite(c.width_mm)) continue;
      const Severed at = severedOf(0.5 * c.width_mm, beam_radius_mm, transmission);
      c.width_mm = 2.0 * at.half_mm;
      c.width_sigma_mm *= at.per_half;
      common_mm = std::max(common_mm, at.common_sigma_mm);
    }
    kerf.widening_sigma_mm = std::hypot(kerf.widening_sigma_mm, 2.0 * common_mm);
  }
  return severed;
}

}  // namespace kerfbench::inspect::checks
