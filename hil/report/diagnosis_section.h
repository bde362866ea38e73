// SPDX-License-Identifier: Apache-2.0
#pragma once

// What is wrong, in verdict.json, on the page and on the terminal. Private to hil/report.

#include <string>

#include "hil/report/json_parts.h"
#include "hil/report/run_report.h"

namespace kerfbench::report {

OrderedJson diagnosisJson(const RunReport& report);
/// Empty of a run that has passed.
std::string diagnosisSection(const RunReport& report);

}  // namespace kerfbench::report
