// SPDX-License-Identifier: Apache-2.0
#include "hil/app/doctor_command.h"

#include <algorithm>
#include <cstdio>

#include "hil/base/terminal.h"
#include "hil/cli/run_guarded.h"
#include "hil/dieline/geometry.h"
#include "hil/doctor/child_check.h"
#include "hil/doctor/doctor.h"
#include "hil/doctor/loopback.h"
#include "hil/witness/witness.h"

namespace kerfbench::app {
namespace {

/// What a scenario that demands a second reader of its drawing has of it.
void addWitness(const scenario::Case& test_case, const std::filesystem::path& bin_dir,
                std::vector<doctor::DoctorFinding>& findings) {
  using Grade = doctor::DoctorFinding::Grade;
  if (!test_case.scenario.witness_required) return;
  const witness::Testimony testimony =
      witness::testimonyOf(*test_case.dieline, test_case.scenario.drawing, witness::witnessBeside(bin_dir));
  const bool agrees = testimony.kind == witness::Testimony::Kind::kAgrees;
  for (const std::string& sentence : testimony.sentences)
    findings.push_back({agrees ? Grade::kGood : Grade::kMissing, "drawing: " + sentence});
}

int examine(const DoctorOptions& options) {
  std::vector<doctor::DoctorFinding> findings;
  std::string name;
  doctor::ComputerState state = doctor::lookAtComputer(source::linuxGpioSystem(), camera::kernelVideoCalls());
  doctor::lookAtAnalysers(*source::sigrokAnalysers(options.bin_dir), state);
  findings = doctor::findingsOf(state);
  if (!options.scenario.empty()) {
    const scenario::Case test_case =
        scenario::readCase(options.scenario, options.bin_dir.parent_path() / "firmware");
    name = test_case.scenario.name;
    const std::vector<doctor::DoctorFinding> needs = doctor::needsOf(test_case, state, options.bin_dir);
    findings.insert(findings.end(), needs.begin(), needs.end());
    addWitness(test_case, options.bin_dir, findings);
  }
  if (options.json)
    base::toTerminalAsItIs(stdout, base::jsonForTerminal(doctor::doctorJson(state, findings, name)));
  else
    base::toTerminal(stdout, doctor::doctorText(state, findings));
  return std::ranges::find(findings, doctor::DoctorFinding::Grade::kMissing, &doctor::DoctorFinding::grade) ==
                 findings.end()
             ? 0
             : 1;
}

int tryChild(const doctor::ChildOptions& options, bool json) {
  const std::vector<doctor::DoctorFinding> findings = doctor::checkChild(options);
  if (json)
    base::toTerminalAsItIs(stdout, base::jsonForTerminal(doctor::findingsJson(findings)));
  else
    base::toTerminal(stdout, doctor::findingsText(findings));
  return std::ranges::all_of(
             findings,
             [](const doctor::DoctorFinding& f) { return f.grade == doctor::DoctorFinding::Grade::kGood; })
             ? 0
             : 1;
}

}  // namespace

int doctorCommand(const DoctorOptions& options) {
  if (options.bench.wanted) return doctor::measureLoopback(options.bench, options.json);
  if (!options.child.child.empty())
    return cli::runGuarded(options.child.image, [&] { return tryChild(options.child, options.json); });
  return cli::runGuarded(options.scenario, [&] { return examine(options); });
}

}  // namespace kerfbench::app
