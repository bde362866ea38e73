// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/recorded_run.h"

#include <algorithm>
#include <span>
#include <stdexcept>

#include "hil/app/case.h"
#include "hil/app/dialogs.h"
#include "hil/app/lockstep.h"
#include "hil/source/open.h"

namespace kerfbench::benchmarks {

RecordedRun record(const std::filesystem::path& scenario, const std::filesystem::path& bin_dir) {
  const hil::Case the_case = hil::readCase(scenario, bin_dir.parent_path() / "firmware");
  hil::PreparedJob job = hil::prepareJob(the_case);
  hil::ChildSourceOptions child;
  child.image = child.child = the_case.scenario.firmware.image;
  child.mcu = the_case.scenario.firmware.mcu;
  const auto source = hil::openChild(child);

  RecordedRun run;
  run.name = the_case.scenario.name;
  run.machine = the_case.machine;
  run.web = hil::webOf(the_case);
  run.rate = source->info().rate;
  twin::Twin twin(run.machine, run.web, run.rate, {.fidelity = twin::Fidelity::kFast});
  hil::LockstepOptions lockstep;
  lockstep.time_limit_s = the_case.scenario.time_limit_s;
  hil::LockstepResult result =
      hil::runLockstep(*source, twin, run.machine.signals, job.dialog.get(), lockstep, {});
  if (!result.problems.empty()) throw std::runtime_error(run.name + ": " + result.problems.front());
  run.events = std::move(result.recording.outputs);
  run.end = result.recording.end;
  return run;
}

double play(const RecordedRun& run, Tick end, const twin::TwinOptions& options) {
  twin::Twin twin(run.machine, run.web, run.rate, options);
  const Tick quantum = run.rate.ticksAt(hil::LockstepOptions{}.quantum_s);
  end = std::min(end, run.end);
  auto next = run.events.begin();
  for (Tick now = 0; now < end;) {
    const Tick until = std::min(now + quantum, end);
    (void)twin.predictSensors(until);
    const auto last = std::upper_bound(next, run.events.end(), until,
                                       [](Tick tick, const PinEvent& event) { return tick < event.tick; });
    twin.advance(until, std::span(next, last));
    (void)twin.takeExposures();
    next = last;
    now = until;
  }
  return run.rate.seconds(end);
}

}  // namespace kerfbench::benchmarks
