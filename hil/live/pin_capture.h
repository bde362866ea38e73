// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hil/base/console.h"
#include "hil/scenario/case.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"

namespace kerfbench::live {

/// Report of the capture, with its circumstances.
void tellCapture(const source::PinCapture& captured, base::Console& console);

/// Records the real pins that the case names, and prints when to start the job, and a report of the capture.
/// @throws InputError if the pins cannot be had: who, where, and what to do.
source::PinCapture captureCase(const scenario::Case& test_case,
                               const std::shared_ptr<source::GpioSystem>& system,
                               const source::GpioChipList& chips, base::Console& console);

}  // namespace kerfbench::live
