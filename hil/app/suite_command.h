// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/suite/run_suite.h"

namespace kerfbench::app {

/// Runs a release test; see suite::runSuite().
int suiteCommand(const suite::SuiteOptions& options);

}  // namespace kerfbench::app
