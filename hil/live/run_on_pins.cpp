// SPDX-License-Identifier: Apache-2.0
#include "hil/live/run_on_pins.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "hil/judge/controller_evidence.h"
#include "hil/judge/kerf_watch.h"
#include "hil/judge/spot_watch.h"
#include "hil/live/live_pins.h"
#include "hil/live/live_spot.h"
#include "hil/live/salvage_evidence.h"
#include "hil/run/dialogs.h"
#include "hil/run/model_machine.h"
#include "hil/run/sensor_lag.h"
#include "hil/source/open.h"
#include "hil/trace/run/run_trace.h"

namespace kerfbench::live {
namespace {

/// Sensors whose edges in the recording have to be those of the machine that is judged: those that the bench
/// drove on real pins, and all that it gave to a controller that it emulated. Of a recording by another
/// program those that it holds; none that a provocation was to change.
std::vector<Signal> sensorsOfMachine(const scenario::Case& test_case, const source::PinRecording& recorded) {
  std::vector<Signal> signals;
  const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
  for (const scenario::PinLine& line : firmware.gpio.outputs) signals.push_back(line.signal);
  const bool is_provoked = test_case.scenario.provoke.cause != scenario::ProvokeChoice::Cause::kNone;
  if (firmware.onRealPins() || is_provoked) return signals;
  const auto is_recorded = [&recorded](Signal signal) {
    return std::ranges::find(recorded.sensor_wires, signal) != recorded.sensor_wires.end() ||
           std::ranges::any_of(recorded.sensors.streamed(),
                               [signal](const SensorEdge& edge) { return edge.signal == signal; });
  };
  for (const Signal signal : {Signal::kEncoderA, Signal::kEncoderB, Signal::kPrintMark, Signal::kLimitX,
                              Signal::kLimitY, Signal::kInterlock}) {
    if (is_recorded(signal)) signals.push_back(signal);
  }
  return signals;
}

/// Whether the inputs of the controller were driven as the machine would have done it.
void judgeSensors(const scenario::Case& test_case, const std::vector<Signal>& signals,
                  const base::SpilledVector<SensorEdge>& due, const source::PinRecording& recorded,
                  run::RecordedRun& run, base::Console& console) {
  const double limit_s = run::sensorLagLimit_s(test_case.scenario);
  const run::SensorLag found =
      run::sensorLag(due, recorded.sensors, recorded.rate, run.recording.end, signals, limit_s);
  console.say(
      fmt::format("  {} edges of sensors: at worst {:.1f} us off the machine's, {:.1f} us rms, limit {:.1f}",
                  found.lag.edges(), 1e-3 * static_cast<double>(found.lag.worst_ns()),
                  1e-3 * found.lag.rms_ns(), 1e6 * limit_s));
  if (found.switch_lag.edges() > 0)
    console.say(fmt::format(
        "  {} edges of limit switches, which answer to pins: at worst {:.1f} ms off the machine's",
        found.switch_lag.edges(), 1e-6 * static_cast<double>(found.switch_lag.worst_ns())));
  run.problems.insert(run.problems.end(), found.problems.begin(), found.problems.end());
  run.guard_problems = found.guard_problems;
}

}  // namespace

int judgeRecorded(const scenario::Case& test_case, const PinsOfMachine& pins, judge::Conclusion conclusion,
                  const judge::RunOptions& options, base::Stopwatch& stopwatch, base::Console& console) {
  const source::PinRecording& recorded = pins.recorded;
  const auto source = source::openRecording(recorded, conclusion.source_id);
  const std::vector<Signal> driven = sensorsOfMachine(test_case, recorded);
  run::ModelOptions model = run::modelOptions(test_case);
  model.beside_real_camera = test_case.scenario.cameras.spot.is_real;
  model.witness_sensors = !driven.empty();
  trace::TraceSource traced_source{
      test_case,           pins.sampled.machine, recorded.rate, conclusion.folder_name,
      conclusion.firmware, conclusion.source_id, pins.program};
  traced_source.recorded = &recorded;
  const std::unique_ptr<trace::RunTrace> traced = trace::tracing(std::move(traced_source), options, console);
  model.onlooker = traced.get();
  run::ModelMachine machine(test_case, pins.sampled, recorded.rate, model);
  const std::unique_ptr<judge::SpotWatch> spot_watch =
      judge::SpotWatch::of(test_case, machine, recorded.rate, options.jobs);
  const std::unique_ptr<judge::KerfWatch> kerf_watch = judge::KerfWatch::of(test_case, machine, options.jobs);
  run::LockstepOptions lockstep;
  lockstep.heard = judge::heardBy(spot_watch.get());
  lockstep.time_limit_s = test_case.scenario.time_limit_s;
  run::RecordedRun run = machine.run(*source, nullptr, lockstep, base::progressOn(console));
  for (std::vector<std::string>* problems : {&run.problems, &run.recording.problems})
    problems->insert(problems->end(), recorded.problems.begin(), recorded.problems.end());
  if (!driven.empty()) judgeSensors(test_case, driven, machine.dueSensors(), recorded, run, console);
  run.recording.sensors = recorded.sensors;
  run.recording.uart = recorded.uart;
  run.recording.stamp_err_ticks = recorded.stamp_err_ticks;
  stopwatch.lap(spot_watch ? "machine, cameras beside it" : "machine");
  conclusion.sampled = &pins.sampled;
  conclusion.machine = &machine;
  conclusion.spot_watch = spot_watch.get();
  conclusion.kerf_watch = kerf_watch.get();
  conclusion.finish_trace = trace::finishing(traced.get(), options, console);
  // A recording without the controller's words is judged by its pins alone.
  if (!recorded.uart.empty()) {
    const bool provoked = test_case.scenario.provoke.cause != scenario::ProvokeChoice::Cause::kNone;
    judge::collectControllerEvidence(test_case, provoked ? run::prepareJob(test_case) : run::PreparedJob{},
                                     recorded, std::numeric_limits<double>::quiet_NaN(), run, conclusion);
  }
  return judge::conclude(test_case, run, conclusion, options, stopwatch, console);
}

int runOnPins(const scenario::Case& test_case, const RealPins& pins, const judge::RunOptions& options,
              base::Stopwatch& stopwatch, base::Console& console) {
  refuseKerfPictures(test_case);
  const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
  const twin::SampledMachine sampled = scenario::sampledMachine(test_case);
  run::PreparedJob job = run::prepareJob(test_case);
  console.say("  " + job.summary);
  console.expect(job.expected_s);
  stopwatch.lap("reading and planning");
  judge::Conclusion conclusion;
  conclusion.folder_name = test_case.scenario.name;
  conclusion.firmware = "real pins of " + pinsName(firmware);
  LiveSpot spot(test_case, options.results_dir, console);
  source::PinRecording recorded;
  trace::KnownProgram program{job.gcode, trace::ProgramOrigin::kPlanned, run::programPeriod_s(job)};
  std::string driven;
  if (firmware.gpio.isLive()) {
    LivePins live = runLive(test_case, sampled, pins, job, console);
    run::tellRemarks(job, console);
    driven = "; " + drivenWords(live);
    conclusion.firmware_version = std::move(job.controller);
    conclusion.gcode = std::move(job.gcode);
    program.from = trace::ProgramOrigin::kSent;
    recorded = std::move(live.captured.recording);
  } else {
    recorded = hearPins(test_case, pins, console).recording;
  }
  for (const std::string& problem : recorded.problems) console.event("problem", {{"text", problem}});
  console.event("operator", {{"text", "Leave the board where it lies until the verdict is there."}});
  conclusion.source_id = fmt::format("{}, stamps within {:.4g} us{}", pinsName(firmware),
                                     1e6 * recorded.rate.seconds(recorded.stamp_err_ticks), driven);
  try {
    spot.finish(conclusion, console);
    stopwatch.lap("real pins");
    return judgeRecorded(test_case, {sampled, recorded, std::move(program)}, std::move(conclusion), options,
                         stopwatch, console);
  } catch (...) {
    salvageEvidence(test_case, recorded, spot.frames(), options.results_dir, console);
    throw;
  }
}

}  // namespace kerfbench::live
