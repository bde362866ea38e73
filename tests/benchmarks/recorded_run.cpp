// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/recorded_run.h"

#include <algorithm>
#include <span>
#include <stdexcept>

#include "hil/run/dialogs.h"
#include "hil/run/lockstep.h"
#include "hil/run/twin_model.h"
#include "hil/scenario/case.h"
#include "hil/source/open.h"

namespace kerfbench::benchmarks {

RecordedRun record(const std::filesystem::path& scenario, const std::filesystem::path& bin_dir) {
  const scenario::Case test_case = scenario::readCase(scenario, bin_dir.parent_path() / "firmware");
  run::PreparedJob job = run::prepareJob(test_case);
  source::ChildSourceOptions child;
  child.image = child.child = test_case.scenario.firmware.image;
  child.mcu = test_case.scenario.firmware.mcu;
  const auto source = source::openChild(child);

  RecordedRun run;
  run.name = test_case.scenario.name;
  run.machine = test_case.machine;
  run.web = scenario::webOf(test_case);
  run.rate = source->info().rate;
  twin::Twin twin(run.machine, run.web, run.rate, {.fidelity = twin::Fidelity::kFast});
  run::TwinModel model(twin);
  run::LockstepOptions lockstep;
  lockstep.time_limit_s = test_case.scenario.time_limit_s;
  run::RecordedRun result =
      run::runLockstep(*source, model, run.machine.signals, job.dialog.get(), lockstep, {});
  if (!result.problems.empty()) throw std::runtime_error(run.name + ": " + result.problems.front());
  run.events.assign(result.recording.outputs.begin(), result.recording.outputs.end());
  run.end = result.recording.end;
  return run;
}

double play(const RecordedRun& run, Tick end, const twin::TwinOptions& options) {
  twin::Twin twin(run.machine, run.web, run.rate, options);
  const Tick quantum = run.rate.ticksAt(run::LockstepOptions{}.quantum_s);
  end = std::min(end, run.end);
  auto next = run.events.begin();
  for (Tick now = 0; now < end;) {
    const Tick until = std::min(now + quantum, end);
    (void)twin.predictSensors(until);
    // Step by step: a search through all events that are left would take a tenth of the twin's own time.
    auto last = next;
    while (last != run.events.end() && last->tick <= until) ++last;
    twin.advance(until, std::span(next, last));
    (void)twin.takeExposures();
    next = last;
    now = until;
  }
  return run.rate.seconds(end);
}

source::PinRecording repeated(const RecordedRun& run, std::size_t times) {
  source::PinRecording recording;
  recording.rate = run.rate;
  for (std::size_t i = 0; i < times; ++i) {
    for (PinEvent event : run.events) {
      event.tick += i * (run.end + 1);
      recording.outputs.push_back(event);
    }
  }
  recording.end = times * (run.end + 1);
  return recording;
}

}  // namespace kerfbench::benchmarks
