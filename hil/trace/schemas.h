// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace kerfbench::trace {

// JSON Schemas, draft 2020-12, of the messages, one for each kind; docs/reference/trace.md explains the
// fields.

std::string machineSchema();
std::string motionSchema();
std::string pinsSchema();
std::string commandedSchema();
std::string gcodeSchema();
std::string uartSchema();
std::string burntSchema();
std::string overviewSchema();
std::string spotSchema();
std::string framesSchema();
std::string checkSchema();

}  // namespace kerfbench::trace
