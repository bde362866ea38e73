// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hil/source/vcd.h"
#include "twin/base/pulse_timing.h"

namespace kerfbench::judge {

/// Standard uncertainty of the time of one edge of a recording whose stamps are off by up to
/// stamp_err_ticks (rectangular, GUM 4.3.7).
double pinUncertainty_s(const source::PinRecording& recording);

/// Times of PUL and DIR that break the drive's data sheet as stamped, but not for certain: the model then
/// takes a step the other way, or none, where the drive may have taken it well. One sentence for each; any
/// makes the evidence INVALID.
std::vector<std::string> unprovenSteps(std::span<const PulseTiming> pulses, double stamp_err_s);

}  // namespace kerfbench::judge
