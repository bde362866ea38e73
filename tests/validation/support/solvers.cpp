// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/support/solvers.h"

#include <utility>

#include "twin/machine/fast_solver.h"
#include "twin/machine/reference_solver.h"

namespace kerfbench::validation {

std::unique_ptr<twin::Solver> solverOf(std::shared_ptr<const twin::Mechanism> mechanism, double step_s,
                                       twin::Fidelity fidelity) {
  if (fidelity == twin::Fidelity::kFast) {
    return std::make_unique<twin::FastSolver>(std::move(mechanism), step_s);
  }
  return std::make_unique<twin::ReferenceSolver>(std::move(mechanism), step_s);
}

std::string nameOf(twin::Fidelity fidelity) {
  return fidelity == twin::Fidelity::kReference ? "reference" : "fast";
}

}  // namespace kerfbench::validation
