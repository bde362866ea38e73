// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/app/head_procedure.h"

namespace kerfbench::hil {

/// What the report tells besides the result.
struct HeadFacts {
  std::string machine;
  std::string command;
  std::string version;
  std::string camera;
};

/// head.json: the iterations, the parameters with their uncertainty, and a digest over all of it but the
/// command.
std::string headJson(const HeadCalibration& result, const HeadPlan& plan, const HeadFacts& facts);

}  // namespace kerfbench::hil
