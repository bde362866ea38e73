// SPDX-License-Identifier: Apache-2.0
#include "hil/base/atomic_file.h"
#include "hil/report/run_report.h"

namespace kerfbench::hil {

void writeReports(const RunReport& report, const std::filesystem::path& folder) {
  // The verdict comes last: whoever finds it finds the rest.
  writeFileAtomically(folder / "report.html", htmlReport(report));
  writeFileAtomically(folder / "junit.xml", junitXml(report));
  writeFileAtomically(folder / "verdict.json", verdictJson(report));
}

}  // namespace kerfbench::hil
