// SPDX-License-Identifier: Apache-2.0
#include "hil/app/filmed_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "hil/base/terminal.h"
#include "hil/run/dialogs.h"
#include "hil/run/lockstep.h"
#include "hil/run/model_machine.h"
#include "hil/run/release.h"

namespace kerfbench::app {

run::MachineFilm filmedRun(const scenario::Case& test_case, const twin::SampledMachine& sampled,
                           std::optional<double> until_s, const std::filesystem::path& bin_dir,
                           base::Console& console) {
  const scenario::Scenario& scenario = test_case.scenario;
  run::PreparedJob job = run::prepareJob(test_case);
  console.say(fmt::format("{}: {}", scenario.name, job.summary));
  const auto source = run::openRelease(scenario.firmware, bin_dir);
  run::ModelMachine machine(
      test_case, sampled, source->info().rate,
      {.fidelity = twin::Fidelity::kFast, .seed = scenario.seed, .record_exposures = false});
  run::LockstepOptions lockstep = run::lockstepFor(test_case);
  if (until_s) lockstep.time_limit_s = std::min(lockstep.time_limit_s, *until_s + lockstep.quantum_s);
  const run::RecordedRun run = machine.run(*source, job.dialog.get(), lockstep, base::progressOn(console));
  // Where the time ends the run, the job is not done, and that is no fault.
  const bool cut_short = until_s && machine.film().end_s() + 1e-9 >= *until_s;
  if (!cut_short) {
    for (const std::string& problem : run.problems)
      base::toTerminal(stderr, fmt::format("{}: {}\n", scenario.name, problem));
  }
  return machine.film();
}

}  // namespace kerfbench::app
