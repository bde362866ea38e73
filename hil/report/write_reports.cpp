// SPDX-License-Identifier: Apache-2.0
#include "hil/base/atomic_file.h"
#include "hil/report/run_report.h"

namespace kerfbench::report {

void writeReports(const RunReport& report, const std::filesystem::path& folder) {
  // The verdict comes last: whoever finds it finds the rest.
  base::writeFileAtomically(folder / "report.html", htmlReport(report));
  base::writeFileAtomically(folder / "junit.xml", junitXml(report));
  base::writeFileAtomically(folder / "verdict.json", verdictJson(report));
}

}  // namespace kerfbench::report
