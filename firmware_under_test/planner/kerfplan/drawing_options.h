// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include "hil/dieline/read.h"

namespace kerfbench::planner {

/// Adds --unit, --scale, --turn, --shift and --layer, which say how a drawing is read.
void addDrawingOptions(CLI::App& app, dieline::DrawingArguments& arguments);

}  // namespace kerfbench::planner
