// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::twin {

struct MechanismDescription;

/// Everything that is wrong with a description, "galvo_x: damping must be in 0.1 … 5; …"; empty if nothing
/// is.
std::string faultsOf(const MechanismDescription& description);

}  // namespace kerfbench::twin
