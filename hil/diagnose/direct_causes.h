// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/diagnose/diagnosis.h"

namespace kerfbench::diagnose {

/// Causes that pins, words, program and pictures show by themselves, in the order in which they weigh.
std::vector<Cause> directCauses(const Evidence& evidence);

}  // namespace kerfbench::diagnose
