// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "hil/report/run_report.h"
#include "tests/hil/inspect/synthetic_run.h"

namespace kerfbench::report::test {

/// Report of a run made by hand, with something in each field.
RunReport reportOf(const inspect::testing::SyntheticRun& run);
/// A run with a fault in most places, to show every part of the page.
inspect::testing::SyntheticRun badRun();

// Files of a report, as written.
inline std::string jsonOf(const RunReport& report) { return verdictJson(report, digestsOf(report)); }
inline std::string junitOf(const RunReport& report) { return junitXml(report, digestsOf(report)); }
inline std::string htmlOf(const RunReport& report) { return htmlReport(report, digestsOf(report)); }

}  // namespace kerfbench::report::test
