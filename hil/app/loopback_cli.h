// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "hil/doctor/loopback.h"

namespace kerfbench::app {

/// `doctor --bench` and what belongs to it.
void addLoopbackOptions(CLI::App& doctor, doctor::LoopbackOptions& options);

}  // namespace kerfbench::app
