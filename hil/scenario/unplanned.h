// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "hil/scenario/scenario.h"

namespace kerfbench::scenario {

/// Why the bench plans no job for a scenario, as words behind `firmware.dialog: `; nothing: it plans one.
std::optional<std::string> whyNothingIsPlanned(const Scenario& scenario);

}  // namespace kerfbench::scenario
