// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/dieline/geometry.h"

namespace kerfbench::dieline {

/// Notes of each layer that a rule ignores how many entities it has.
void noteIgnoredLayers(Dieline& dieline);

}  // namespace kerfbench::dieline
