// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "hil/base/console.h"
#include "hil/scenario/case.h"
#include "hil/source/gpio/capture.h"
#include "hil/source/gpio/chips.h"

namespace kerfbench::live {

/// What came, and what is worth knowing.
void tellCapture(const source::PinCapture& captured, base::Console& console);

/// Records the real pins that the case names, and tells the user when to start the job, and what came.
/// @throws InputError if the pins cannot be had: who, where, and what to do.
source::PinCapture captureCase(const scenario::Case& test_case,
                               const std::shared_ptr<source::GpioSystem>& system,
                               const source::GpioChipList& chips, base::Console& console);

}  // namespace kerfbench::live
