// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

#include "hil/app/commands.h"
#include "hil/app/conclude.h"
#include "hil/app/cut_on_twin.h"
#include "hil/app/dialogs.h"
#include "hil/app/exit_codes.h"
#include "hil/app/live_pins.h"
#include "hil/app/live_spot.h"
#include "hil/app/machine_film.h"
#include "hil/app/model_parting.h"
#include "hil/app/pin_sums.h"
#include "hil/app/real_pins.h"
#include "hil/app/recording_file.h"
#include "hil/app/release.h"
#include "hil/app/safe_demand.h"
#include "hil/app/sensor_lag.h"
#include "hil/base/digest.h"
#include "hil/base/yaml_reader.h"
#include "hil/source/open.h"
#include "hil/source/vcd.h"

namespace kerfbench::hil {
namespace {

namespace fs = std::filesystem;

std::string sourceName(FirmwareChoice::Source source) {
  switch (source) {
    case FirmwareChoice::Source::kAvr:
      return "AVR emulator";
    case FirmwareChoice::Source::kNative:
      return "native build";
    case FirmwareChoice::Source::kChild:
    case FirmwareChoice::Source::kGpio:  // Have no image; see runOnPins().
    case FirmwareChoice::Source::kAnalyser:
      break;
  }
  return "child process";
}

Case caseWithOptions(const fs::path& path, const CommonOptions& options) {
  Case the_case = readCase(path, options.bin_dir.parent_path() / "firmware");
  if (options.seed) the_case.scenario.seed = *options.seed;
  if (options.imperfections) the_case.scenario.imperfections = presetFromName(*options.imperfections);
  if (options.twin) the_case.scenario.fidelity = fidelityFromName(*options.twin);
  if (options.time_limit_s) the_case.scenario.time_limit_s = *options.time_limit_s;
  return the_case;
}

ProgressFn progressOn(Console& console) {
  return [&console](double now_s, const std::string& what) { console.progress(now_s, what); };
}

constexpr double kSettleAfterStop_s = 0.5;  // for a controller that might go on by itself

/// A controller that nothing reaches any more cannot answer the last question.
bool canBeAsked(const ProvokeChoice& provoke) {
  return provoke.cause != ProvokeChoice::Cause::kUartSilent &&
         provoke.cause != ProvokeChoice::Cause::kUartNoise;
}

void addProblem(const std::string& problem, LockstepResult& run) {
  if (!problem.empty()) run.problems.push_back(problem);
}

/// A replay has no dialog that could fail.
void spoilByDialog(LockstepResult& run) {
  addProblem(run.dialog_failure, run);
  if (!run.dialog_failure.empty()) run.recording.problems.push_back(run.dialog_failure);
}

/// What the controller itself said of the run, and of its end; what that leaves unproven is a problem.
void hearController(const Case& the_case, const PreparedJob& job, const PinRecording& recording,
                    double line_cut_s, LockstepResult& run, Conclusion& conclusion) {
  if (the_case.scenario.firmware.dialog != FirmwareChoice::Dialog::kKerfbench) {
    spoilByDialog(run);
    return;
  }
  const PinSums pins(recording, the_case.machine.signals);
  const ControllerEar ear(recording);
  conclusion.words.account = pins.accountBeside(ear.account(), the_case.scenario.firmware.baud);
  const ProvokeChoice& provoke = the_case.scenario.provoke;
  if (provoke.cause == ProvokeChoice::Cause::kNone) {
    conclusion.words.end = controllerEnd(ear, pins, recording);
    addProblem(unprovenEnd(*conclusion.words.end, run), run);
    return;
  }
  SafeStateEvidence evidence;
  evidence.demand = safeStateDemand(the_case, job, pins, line_cut_s);
  evidence.last_pulse_s = pins.lastPulse_s();
  evidence.end_s = recording.rate.seconds(recording.end);
  evidence.reports = ear.reports();
  if (canBeAsked(provoke)) evidence.account = conclusion.words.account;
  evidence.problems = run.problems;
  conclusion.safe_state = std::move(evidence);
}

/// Pins that are recorded already, and how they came about.
struct Recorded {
  PinRecording pins;
  std::string dialog_failure;  ///< As LockstepResult's.
  double dialog_failed_s{};
};

/// Whether the inputs of a controller on real pins were driven as the machine would have done it.
void judgeSensors(const Case& the_case, const WitnessedTwin& twin, const PinRecording& recorded,
                  LockstepResult& run, Console& console) {
  std::vector<Signal> signals;
  for (const PinLine& line : the_case.scenario.firmware.gpio.outputs) signals.push_back(line.signal);
  const double limit_s = sensorLagLimit_s(the_case.scenario);
  const SensorLag found =
      sensorLag(twin.due(), recorded.sensors, recorded.rate, run.recording.end, signals, limit_s);
  console.say(
      fmt::format("  {} edges of sensors: at worst {:.1f} us off the machine's, {:.1f} us rms, limit {:.1f}",
                  found.lag.edges(), 1e-3 * static_cast<double>(found.lag.worst_ns()),
                  1e-3 * found.lag.rms_ns(), 1e6 * limit_s));
  run.problems.insert(run.problems.end(), found.problems.begin(), found.problems.end());
}

/// Twin and judge behind pins that are recorded already.
int judgeRecorded(const Case& the_case, const twin::DrawnMachine& drawn, const Recorded& before,
                  Conclusion conclusion, const CommonOptions& options, Stopwatch& stopwatch,
                  Console& console) {
  const PinRecording& recorded = before.pins;
  const auto source = openRecording(recorded, conclusion.source_id);
  const bool is_real = the_case.scenario.cameras.spot.is_real;
  twin::Twin twin(is_real ? watchedDensely(drawn.machine) : drawn.machine, webOf(the_case), recorded.rate,
                  twinOptions(the_case));
  MachineFilm film(drawn.machine.laser.full_power_w);
  FilmedSource filmed(*source, twin, film);
  LockstepOptions lockstep;
  lockstep.time_limit_s = the_case.scenario.time_limit_s;
  const bool driven = !the_case.scenario.firmware.gpio.outputs.empty();
  WitnessedTwin witnessed(twin);
  TwinModel alone(twin);
  LockstepModel& model = driven ? static_cast<LockstepModel&>(witnessed) : alone;
  LockstepResult run =
      runLockstep(filmed, model, the_case.machine.signals, nullptr, lockstep, progressOn(console));
  for (std::vector<std::string>* problems : {&run.problems, &run.recording.problems})
    problems->insert(problems->end(), recorded.problems.begin(), recorded.problems.end());
  run.dialog_failure = before.dialog_failure;
  run.dialog_failed_s = before.dialog_failed_s;
  if (driven) judgeSensors(the_case, witnessed, recorded, run, console);
  run.recording.sensors = recorded.sensors;
  run.recording.uart = recorded.uart;
  run.recording.stamp_err_ticks = recorded.stamp_err_ticks;
  film.add(twin);
  stopwatch.lap("machine");
  conclusion.drawn = &drawn;
  conclusion.film = &film;
  // A recording without the controller's words is judged by its pins alone.
  if (!recorded.uart.empty()) {
    const bool provoked = the_case.scenario.provoke.cause != ProvokeChoice::Cause::kNone;
    hearController(the_case, provoked ? prepareJob(the_case) : PreparedJob{}, recorded,
                   std::numeric_limits<double>::quiet_NaN(), run, conclusion);
  } else {
    spoilByDialog(run);
  }
  return conclude(the_case, twin, run, conclusion, options, stopwatch, console);
}

int replayOne(const fs::path& recording, const fs::path& scenario, const fs::path& frames,
              const CommonOptions& options) {
  Stopwatch stopwatch;
  Console console(options.quiet);
  const Case the_case = caseWithOptions(scenario, options);
  console.say(fmt::format("{}: {}, replayed from {}", the_case.scenario.name, the_case.scenario.title,
                          recording.string()));
  const twin::DrawnMachine drawn = drawnMachine(the_case);
  Recorded recorded;
  Conclusion conclusion;
  try {
    recorded.pins = readRecording(recording, the_case);
    conclusion.source_id = "recording sha256 " + sha256File(recording);
  } catch (const std::runtime_error& e) {
    throw InputFault(e.what());
  }
  stopwatch.lap("reading");
  conclusion.spot_frames = framesOfReplay(the_case, recording, frames);
  conclusion.folder_name = the_case.scenario.name + "-replay";
  conclusion.firmware = "recording " + recording.filename().string();
  return judgeRecorded(the_case, drawn, recorded, std::move(conclusion), options, stopwatch, console);
}

int runOne(const fs::path& path, const CommonOptions& options) {
  Stopwatch stopwatch;
  Console console(options.quiet);
  const Case the_case = caseWithOptions(path, options);
  const Scenario& scenario = the_case.scenario;
  console.say(fmt::format("{}: {}", scenario.name, scenario.title));
  if (scenario.firmware.onRealPins())
    return runOnPins(the_case, realPins(options.bin_dir), options, stopwatch, console);
  refuseRealCamera(the_case);
  const twin::DrawnMachine drawn = drawnMachine(the_case);
  PreparedJob job = prepareJob(the_case);
  console.say("  " + job.summary);
  stopwatch.lap("reading and planning");

  const auto source = openRelease(scenario.firmware, options.bin_dir);
  const SourceInfo info = source->info();
  twin::Twin twin(drawn.machine, webOf(the_case), info.rate, twinOptions(the_case));
  MachineFilm film(drawn.machine.laser.full_power_w);
  FilmedSource filmed(*source, twin, film);
  LockstepOptions lockstep;
  lockstep.time_limit_s = scenario.time_limit_s;
  const bool provoked = scenario.provoke.cause != ProvokeChoice::Cause::kNone;
  Provocation provocation(scenario.provoke, info.rate, scenario.seed);
  if (provoked) {
    lockstep.provocation = &provocation;
    lockstep.settle_s = kSettleAfterStop_s;
  }
  LockstepResult run =
      runLockstep(filmed, twin, the_case.machine.signals, job.dialog.get(), lockstep, progressOn(console));
  if (provoked) console.say("  " + job.dialog->message());
  film.add(twin);
  stopwatch.lap("firmware and machine");

  Conclusion conclusion;
  conclusion.folder_name = scenario.name;
  conclusion.firmware = fmt::format("{} ({})", scenario.firmware.image.filename().string(),
                                    sourceName(scenario.firmware.source));
  conclusion.source_id = info.config_id;
  conclusion.drawn = &drawn;
  conclusion.film = &film;
  conclusion.firmware_sha256 = sha256File(scenario.firmware.image);
  conclusion.firmware_version = std::move(job.controller);
  conclusion.gcode = std::move(job.gcode);
  hearController(the_case, job, run.recording, provocation.lineCut_s(), run, conclusion);
  return conclude(the_case, twin, run, conclusion, options, stopwatch, console);
}

}  // namespace

int runOnPins(const Case& the_case, const RealPins& pins, const CommonOptions& options, Stopwatch& stopwatch,
              Console& console) {
  const FirmwareChoice& firmware = the_case.scenario.firmware;
  const twin::DrawnMachine drawn = drawnMachine(the_case);
  PreparedJob job = prepareJob(the_case);
  console.say("  " + job.summary);
  stopwatch.lap("reading and planning");
  Conclusion conclusion;
  conclusion.folder_name = the_case.scenario.name;
  conclusion.firmware = "real pins of " + pinsName(firmware);
  LiveSpot spot(the_case, options.results_dir, console);
  Recorded recorded;
  std::string driven;
  if (firmware.gpio.isLive()) {
    LivePins live = runLive(the_case, drawn, pins, job, console);
    driven = fmt::format("; {} edges driven, at worst {:.1f} us behind their plan, {:.1f} us rms",
                         live.lag.edges(), 1e-3 * static_cast<double>(live.lag.worst_ns()),
                         1e-3 * live.lag.rms_ns());
    conclusion.firmware_version = std::move(job.controller);
    conclusion.gcode = std::move(job.gcode);
    recorded = {std::move(live.captured.recording), std::move(live.dialog_failure), live.dialog_failed_s};
    // Said by the recording, as in a replay; the reference controller's is judged by its own words.
    if (firmware.dialog != FirmwareChoice::Dialog::kKerfbench && !recorded.dialog_failure.empty())
      recorded.pins.problems.push_back(std::exchange(recorded.dialog_failure, {}));
  } else {
    recorded.pins = hearPins(the_case, pins, console).recording;
  }
  conclusion.source_id = fmt::format("{}, stamps within {:.4g} us{}", pinsName(firmware),
                                     1e6 * recorded.pins.rate.seconds(recorded.pins.stamp_err_ticks), driven);
  spot.finish(conclusion, console);
  stopwatch.lap("real pins");
  return judgeRecorded(the_case, drawn, recorded, std::move(conclusion), options, stopwatch, console);
}

int runCommand(const std::vector<fs::path>& scenarios, const CommonOptions& options) {
  int code = 0;
  for (const fs::path& scenario : scenarios) {
    code = gravest(code, guarded(scenario, [&] { return runOne(scenario, options); }));
  }
  return code;
}

int replayCommand(const fs::path& recording, const fs::path& scenario, const fs::path& frames,
                  const CommonOptions& options) {
  return guarded(scenario, [&] { return replayOne(recording, scenario, frames, options); });
}

}  // namespace kerfbench::hil
