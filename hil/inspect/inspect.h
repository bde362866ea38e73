// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/inspect/evidence/evidence.h"
#include "hil/inspect/evidence/results.h"
#include "hil/inspect/verdict/tolerances.h"

namespace kerfbench::inspect {

/// Compares what was measured with the dieline. Pure: the same evidence gives the same result, to the bit.
/// Checks that do not apply (no crease: no depth check), those that make no sense of a sheet on which nothing
/// was cut (which the coverage check fails), and those whose evidence was not taken are listed as unjudged,
/// each with its reason. Everything else that could not be measured is INVALID. Of a controller that stopped
/// by itself before its first cut, pins and words alone are judged.
InspectionResult inspect(const Evidence& evidence, const Tolerances& limits);

}  // namespace kerfbench::inspect
