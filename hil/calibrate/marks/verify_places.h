// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace kerfbench::calibrate {

/// Request for places that verify a correction.
struct VerifyPlaces {
  int count{};
  double mark_size_mm{};
  std::vector<Eigen::Vector2d> marked;   ///< Marks of the fit; no new place is one of them.
  std::vector<Eigen::Vector2d> middles;  ///< Middles of the table's cells, where it interpolates farthest.
  std::uint64_t seed{1};
};

/// Sheets of places to mark, as many as they need to be a third full at most, of about equal numbers. On each
/// sheet a tenth of the places lies on the field's rim, a tenth in middles of the table's cells as long as
/// there are any that were not marked, and all others anywhere, sampled evenly. No place lies within a
/// quarter of a mark's size of one that was marked for the fit, along x and along y.
/// @throws std::invalid_argument for an empty field, a size or count that is not positive, or no room.
std::vector<std::vector<Eigen::Vector2d>> verifySheets(const Eigen::AlignedBox2d& field_mm,
                                                       const VerifyPlaces& request);

}  // namespace kerfbench::calibrate
