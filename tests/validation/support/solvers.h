// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "twin/description/fidelity.h"
#include "twin/machine/solver.h"

namespace kerfbench::validation {

/// Solver of a fidelity, as the machine would have it.
std::unique_ptr<twin::Solver> solverOf(std::shared_ptr<const twin::Mechanism> mechanism, double step_s,
                                       twin::Fidelity fidelity);

/// Name of a fidelity: "reference", "fast".
std::string nameOf(twin::Fidelity fidelity);

}  // namespace kerfbench::validation
