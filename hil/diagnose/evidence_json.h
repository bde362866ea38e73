// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/diagnose/evidence.h"

namespace kerfbench::diagnose {

/// Evidence as JSON, so that a run can be diagnosed again without it.
std::string evidenceJson(const Evidence& evidence);
/// @throws std::runtime_error for a text that evidenceJson() has not written.
Evidence evidenceFromJson(const std::string& text);

}  // namespace kerfbench::diagnose
