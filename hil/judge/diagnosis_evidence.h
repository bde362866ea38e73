// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/diagnose/evidence.h"
#include "hil/inspect/evidence/evidence.h"
#include "hil/inspect/evidence/results.h"
#include "hil/scenario/case.h"
#include "hil/source/vcd.h"

namespace kerfbench::judge {

/// What a diagnosis may know of a run: drawing, program and data sheets of `test_case`, the recorded pins,
/// and what cameras and inspection have found. The sampled machine has no part in it.
diagnose::Evidence diagnosisEvidence(const scenario::Case& test_case, const source::PinRecording& recording,
                                     const inspect::Evidence& evidence,
                                     const inspect::InspectionResult& result);

}  // namespace kerfbench::judge
