// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "firmware_under_test/planner/compensation/proof.h"

namespace kerfbench::planner {

/// Halves of prove().
void proveSpace(Proof& proof);
void provePlane(Proof& proof);

}  // namespace kerfbench::planner
