// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/machine_file/machine_file.h"

namespace kerfbench::machine_file {

/// Refuses a machine that the twin cannot run with this web.
/// @throws ConfigError with every fault, each at the file and line of the key that it names, if it names one.
void refuseUnfit(const MachineFile& file, const twin::WebDescription& web);
/// Refuses a machine that the twin cannot run with a web that the line moves or, if it has a feed, with one
/// that the feed moves.
void refuseUnfit(const MachineFile& file);

}  // namespace kerfbench::machine_file
