// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/validation/strip_controller.h"
#include "twin/description/fidelity.h"

namespace kerfbench::validation {

/// Cut times of the first pieces on the whole twin, as CutPiece::cut_s.
std::vector<double> cutTimesOfTwin_s(const twin::MachineDescription& machine, const StripJob& job,
                                     twin::Fidelity fidelity, int pieces);

}  // namespace kerfbench::validation
