// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "hil/vision/kerf/kerf_plan.h"
#include "hil/vision/scan/sight_depth.h"
#include "hil/vision/scan/sight_pairs.h"

namespace kerfbench::vision {

/// Places of one unit's lines that two pictures show differently.
struct TileContradictions {
  std::size_t compared{};  ///< Places that two pictures show, each with one line in sight.
  std::size_t light{};     ///< Places that are burnt in the one and not, or less, in the other.
  std::size_t place{};     ///< Places where the kerf lies elsewhere.
  /// The first of either kind.
  int entity{};
  Eigen::Vector2d p_S_mm{Eigen::Vector2d::Zero()};
  std::size_t tile{}, other{};

  [[nodiscard]] std::size_t count() const { return light + place; }
};

/// Compares the picture that is used at each station with all others that show it. Pictures of one sheet can
/// differ by noise, by where the table stopped and by how aslant they see the board's thickness; what is
/// beyond that was not there in both.
TileContradictions compareTiles(const KerfPlan& plan, const OverlapScene& scene, const SightDepths& depths);

}  // namespace kerfbench::vision
