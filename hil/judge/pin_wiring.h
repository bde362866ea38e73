// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/evidence/pin_evidence.h"
#include "hil/scenario/case.h"

namespace kerfbench::judge {

/// How the machine of a case is wired, as its machine file describes it: the drives that it has, in the order
/// galvo, gantry, feed.
evidence::PinWiring pinWiring(const scenario::Case& test_case);

}  // namespace kerfbench::judge
