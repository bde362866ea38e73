// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/fold/fold_run.h"

namespace kerfbench::app {

/// Runs scenarios of five-axis cuts one after the other. Returns the worst exit code.
int foldCommand(const fold::FoldOptions& options);

}  // namespace kerfbench::app
