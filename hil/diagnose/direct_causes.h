// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hil/diagnose/diagnosis.h"

namespace kerfbench::diagnose {

/// Key of a beam that no camera sees.
inline constexpr const char* kBeamUnseen = "beam_unseen";

/// Causes that pins, words, program and pictures show by themselves, in the order in which they weigh.
std::vector<Cause> directCauses(const Evidence& evidence);

}  // namespace kerfbench::diagnose
