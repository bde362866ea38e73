// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hil/report/run_report.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::report::test {

/// Report of a run made by hand, with something in each field.
RunReport reportOf(const inspect::testing::SyntheticRun& run);
/// A run with a fault in most places, to show every part of the page.
inspect::testing::SyntheticRun badRun();

}  // namespace kerfbench::report::test
