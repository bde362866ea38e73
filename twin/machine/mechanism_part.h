// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "twin/machine/mechanism.h"

namespace kerfbench::twin {

/// A group of joints of a mechanism that nothing ties to the others: a mechanism of its own.
struct MechanismPart {
  /// Joints in the numbering of the whole, ascending: joint i of the part is joints[i] of the whole.
  std::vector<std::size_t> joints;
  std::vector<std::size_t> drives;  ///< Inputs in the numbering of the whole, ascending.
  ForceLaw law;                     ///< Forces within the part, with the part's own indices.
  Eigen::MatrixXd inverse_mass;
  std::vector<double> start;        ///< State at t = 0.
  std::vector<double> most_speeds;  ///< Largest plausible speed of each joint.
};

/// Splits a mechanism into its parts, ordered by their first joint. Joints that nothing can ever move, such
/// as a frame without a gantry or a sheet across a belt that pulls only along, are in none of them.
std::vector<MechanismPart> partsOf(const Mechanism& mechanism);

}  // namespace kerfbench::twin
