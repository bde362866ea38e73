// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "twin/machine/mechanism.h"

namespace kerfbench::twin {

/// Some joints of a mechanism that nothing ties to the others: a mechanism of its own.
struct MechanismPart {
  std::vector<std::size_t> joints;  ///< Joints in the numbering of the whole, ascending: the part's joint i
                                    ///< is the whole's joints[i].
  std::vector<std::size_t> drives;  ///< Likewise for the inputs.
  ForceLaw law;                     ///< With the part's own numbers.
  Eigen::MatrixXd inverse_mass;
  std::vector<double> start;  ///< State at t = 0.
};

/// The parts of a mechanism, by their first joint. Joints that nothing can ever move, such as a frame without
/// a gantry or a sheet across a belt that pulls only along, are in none of them.
std::vector<MechanismPart> partsOf(const Mechanism& mechanism);

}  // namespace kerfbench::twin
