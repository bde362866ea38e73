// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "hil/base/atomic_file.h"
#include "hil/base/parallel.h"
#include "hil/report/run_report.h"

namespace kerfbench::report {

void writeReports(const RunReport& report, const Digests& digests, const std::filesystem::path& folder,
                  int threads) {
  using Page = std::string (*)(const RunReport&, const Digests&);
  constexpr std::array<Page, 3> kPages{htmlReport, junitXml, verdictJson};
  std::array<std::string, 3> text;
  base::forEachIndex(text.size(), threads, [&](std::size_t i) { text[i] = kPages[i](report, digests); });
  // The verdict comes last: whoever finds it finds the rest.
  base::writeFileAtomically(folder / "report.html", text[0]);
  base::writeFileAtomically(folder / "junit.xml", text[1]);
  base::writeFileAtomically(folder / "verdict.json", text[2]);
}

}  // namespace kerfbench::report
