// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>

#include "hil/app/commands.h"
#include "hil/app/doctor.h"
#include "hil/app/doctor_bench.h"
#include "hil/app/exit_codes.h"

namespace kerfbench::hil {
namespace {

int examine(const DoctorOptions& options) {
  std::vector<DoctorFinding> findings;
  std::string name;
  ComputerState state = lookAtComputer(linuxGpioSystem(), kernelVideoCalls());
  lookAtAnalysers(*sigrokAnalysers(options.bin_dir), state);
  findings = findingsOf(state);
  if (!options.scenario.empty()) {
    const Case the_case = readCase(options.scenario, options.bin_dir.parent_path() / "firmware");
    name = the_case.scenario.name;
    const std::vector<DoctorFinding> needs = needsOf(the_case, state, options.bin_dir);
    findings.insert(findings.end(), needs.begin(), needs.end());
  }
  std::fputs((options.json ? doctorJson(state, findings, name) : doctorText(state, findings)).c_str(),
             stdout);
  return std::ranges::find(findings, DoctorFinding::Grade::kMissing, &DoctorFinding::grade) == findings.end()
             ? 0
             : 1;
}

}  // namespace

int doctorCommand(const DoctorOptions& options) {
  if (options.bench.wanted) return loopBackCommand(options);
  return guarded(options.scenario, [&] { return examine(options); });
}

}  // namespace kerfbench::hil
