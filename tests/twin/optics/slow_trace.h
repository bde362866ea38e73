// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <Eigen/Geometry>

#include "twin/optics/optics_description.h"

namespace kerfbench::twin::test {

/// Height of the board at a place in W.
using Board = std::function<double(const Eigen::Vector2d& p_WQ_mm)>;

struct SlowSpot {
  Eigen::Vector3d p_W_mm;
  Eigen::Vector3d direction;
  double path_mm{};     ///< Length of path from the first mirror's axis, along the beam; without a lens.
  double defocus_mm{};  ///< Distance from the waist to the board along the ray.
};

/// Scan head by an independent trace from its description: poses as matrices, mirrors as hyperplanes, the
/// board found by bisection. No line of it is shared with ScanHead. The beam must reach the board.
/// `offset_mm`: displacement of the ray from the laser beam's axis, along Hy and Hz.
SlowSpot slowTrace(const ScanHeadDescription& head, const BeamDescription& beam,
                   const Eigen::Vector2d& mirror_rad, const Board& board,
                   const Eigen::Vector2d& offset_mm = Eigen::Vector2d::Zero());

}  // namespace kerfbench::twin::test
