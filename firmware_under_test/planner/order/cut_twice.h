// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "firmware_under_test/planner/geometry/segment.h"

namespace kerfbench::planner {

/// Finds marks that run along another one (within 0.01 mm, for more than 0.05 mm) and so are burnt twice, as
/// by a copied line of G-code. One sentence for each, with both lines; the first hundred.
std::vector<std::string> cutTwice(const std::vector<Segment>& path);

}  // namespace kerfbench::planner
