// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "firmware_under_test/planner/strip/strip_path.h"
#include "firmware_under_test/planner/strip/throughput.h"

namespace kerfbench::planner {

/// S0's figure 5: the way of the head in the plane of the machine.
std::string stripPathPicture(const StripPath& path);
/// S0's figure 6: G(t), the length of the head's way over time.
std::string stripLengthPicture(const StripPath& path);
/// S0's figure 7: time over pieces by both methods, by formula and with ramps.
std::string throughputPicture(const Throughput& throughput);

}  // namespace kerfbench::planner
