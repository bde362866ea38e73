// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "twin/description/description.h"

namespace kerfbench::twin {

/// Everything that is impossible in a machine and its web, each fault a sentence with names, values and
/// units; empty if the twin can run it. Faults are values that are not numbers, absurdly large, or masses of
/// nothing; springs and servos that steps of 10 us cannot follow; a servo that is unstable, or one that its
/// motor's load cannot follow; motors too weak for their friction; a field that the head or the gantry's
/// travel does not reach; two signals on one pin. Only parts that this machine uses with this web are
/// checked.
std::vector<std::string> faultsOf(const MachineDescription& machine, const WebDescription& web);

}  // namespace kerfbench::twin
