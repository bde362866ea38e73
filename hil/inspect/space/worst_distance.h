// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hil/inspect/space/space_readings.h"
#include "hil/inspect/verdict/uncertainty.h"

namespace kerfbench::inspect {

/// The largest distance of many places.
struct WorstDistance {
  Quantity value;          ///< mm, with U (k = 2); NaN without a reading.
  double as_read_mm{};     ///< Before the correction for being the largest of many.
  std::size_t reading{};   ///< Where, in the readings.
  std::size_t readings{};  ///< How many were judged.
  double noise_u_mm{};     ///< Standard uncertainty by noise, as simulated.
  double shared_u_mm{};    ///< Standard uncertainty at the worst place by what readings have in common.
  double most_mm{};        ///< Largest of all distances with their own U: none is shown to be beyond it.
  /// The distance whose difference from its own U (k = 2) is the largest.
  Quantity surest;
  std::size_t surest_reading{};
  std::array<double, kEdgeSources> source_u_mm{};  ///< Parts of it at the worst place.
};

/// Largest distance of the edge from the contour along all readings of EdgeZone::kAlong. Each is the mean of
/// three neighbours (0.2 mm from the first to the last), so that a notch longer than that keeps its height.
///
/// The largest of noisy distances is too large on average. By how much, and how far it scatters, is simulated
/// 400 times with noise alone, from a likely truth: the readings' means over 1.1 mm. Errors that readings
/// have in common are not taken off: they are added to U with what they come to in the direction of the
/// reading's own deviation. Readings that are known less well than the worst are not lost: see most_mm.
WorstDistance worstDistance(const std::vector<EdgeReading>& readings, std::uint64_t seed);

/// A reading averaged with its neighbours on the line, `half` to each side as far as they are found and
/// without a gap; 0: alone.
struct MeanReading {
  double beside_mm{}, above_mm{};
  double noise_mm{};
};
MeanReading meanReading(const std::vector<EdgeReading>& readings, std::size_t at, std::size_t half);

/// Standard uncertainty of a component of a reading in a direction (beside, above), by its shared errors.
double sharedU_mm(const EdgeReading& reading, const Eigen::Vector2d& direction);

}  // namespace kerfbench::inspect
