// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/base/console.h"
#include "hil/scenario/case.h"
#include "hil/source/analyser/capture.h"

namespace kerfbench::live {

/// Captures as captureCase() does, by the logic analyser that the case names.
/// @throws InputError if the analyser cannot be had: which, where, and what there is.
source::PinCapture captureAnalyserCase(const scenario::Case& test_case, source::AnalyserSystem& analysers,
                                       base::Console& console);

}  // namespace kerfbench::live
