// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "hil/app/commands.h"

namespace kerfbench::hil {

/// `doctor --bench` and what belongs to it.
void addBenchOptions(CLI::App& doctor, BenchOptions& options);

}  // namespace kerfbench::hil
