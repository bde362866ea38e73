// SPDX-License-Identifier: Apache-2.0
#include "hil/app/run_command.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "hil/app/drawing_witness.h"
#include "hil/base/digest.h"
#include "hil/base/exit_codes.h"
#include "hil/base/file_content.h"
#include "hil/base/yaml_reader.h"
#include "hil/cli/for_option.h"
#include "hil/cli/run_guarded.h"
#include "hil/cli/standard_input.h"
#include "hil/judge/conclude.h"
#include "hil/judge/controller_evidence.h"
#include "hil/judge/kerf_watch.h"
#include "hil/judge/run_folder.h"
#include "hil/judge/run_options.h"
#include "hil/judge/spot_watch.h"
#include "hil/live/live_spot.h"
#include "hil/live/real_pins.h"
#include "hil/live/recording_file.h"
#include "hil/live/run_on_pins.h"
#include "hil/run/controller_fit.h"
#include "hil/run/dialogs.h"
#include "hil/run/model_machine.h"
#include "hil/run/release.h"
#include "hil/trace/run/run_trace.h"

namespace kerfbench::app {
namespace {

namespace fs = std::filesystem;

std::string sourceName(const scenario::FirmwareChoice& firmware) {
  if (const scenario::Emulator* emulator = firmware.emulator())
    return fmt::format("{} emulator", emulator->runs);
  return firmware.source == scenario::FirmwareChoice::Source::kNative ? "native build" : "child process";
}

scenario::Case caseWithOptions(const fs::path& path, const fs::path& image, const judge::RunOptions& options,
                               base::Console& console) {
  scenario::Case test_case = scenario::readCase(path, {options.bin_dir.parent_path() / "firmware", image},
                                                base::progressOn(console));
  if (options.seed) test_case.scenario.seed = *options.seed;
  if (options.imperfections)
    test_case.scenario.imperfections = scenario::presetFromName(*options.imperfections);
  if (options.twin) test_case.scenario.fidelity = scenario::fidelityFromName(*options.twin);
  if (options.time_limit_s) test_case.scenario.time_limit_s = *options.time_limit_s;
  return test_case;
}

/// The program that the pins of a recording have followed, as far as it can be known.
trace::KnownProgram programOf(const scenario::Case& test_case, const fs::path& recording) {
  trace::KnownProgram program;
  program.from = trace::ProgramOrigin::kPlanned;
  try {
    run::PreparedJob job = run::prepareJob(test_case);
    program.period_s = run::programPeriod_s(job);
    program.gcode = std::move(job.gcode);
  } catch (const std::runtime_error&) {
    // The pins are there and are judged; without a program the trace only lacks one.
  }
  if (auto text = base::fileContent(fs::absolute(recording).parent_path() / judge::kJobFile)) {
    program.gcode = *std::move(text);
    program.from = trace::ProgramOrigin::kRecorded;
  }
  return program;
}

constexpr double kSettleAfterStop_s = 0.5;  // for a controller that might go on by itself

/// `name`: of the recording, for people.
int replayOne(const Replay& replay, const std::string& name, const judge::RunOptions& options) {
  base::Stopwatch stopwatch;
  base::Console console =
      cli::forOption("--events", [&] { return base::Console(options.quiet, options.events); });
  console.beVerbose(options.verbose);
  scenario::Case test_case = caseWithOptions(replay.scenario, replay.image, options, console);
  const fs::path& recording = replay.recording;
  judge::refuseBlockedRuns(options.results_dir, test_case.scenario.name + "-replay", options.output);
  console.say(
      fmt::format("{}: {}, replayed from {}", test_case.scenario.name, test_case.scenario.title, name));
  if (const auto code =
          refusedByWitness(test_case, test_case.scenario.name + "-replay", options, stopwatch, console))
    return *code;
  const twin::SampledMachine sampled = scenario::sampledMachine(test_case);
  source::PinRecording recorded;
  judge::Conclusion conclusion;
  try {
    recorded = live::readRecording(recording, test_case, base::progressOn(console));
    conclusion.source_id = "recording sha256 " + base::sha256File(recording, base::progressOn(console));
  } catch (const std::runtime_error& e) {
    throw base::InputError(e.what());
  }
  conclusion.unsealed = !recorded.sealed;
  stopwatch.lap("reading");
  conclusion.spot_frames = live::framesOfReplay(test_case, recording, replay.frames);
  conclusion.folder_name = test_case.scenario.name + "-replay";
  conclusion.firmware = "recording " + recording.filename().string();
  trace::KnownProgram program;
  if (options.trace) program = programOf(test_case, recording);
  return live::judgeRecorded(test_case, {sampled, recorded, std::move(program)}, std::move(conclusion),
                             options, stopwatch, console);
}

/// The release, running; says where it is not kept from files and network.
std::unique_ptr<source::SignalSource> openTold(const scenario::FirmwareChoice& firmware,
                                               const judge::RunOptions& options, base::Console& console) {
  auto source = run::openRelease(firmware, options.bin_dir);
  const std::string unconfined = source->info().unconfined;
  if (!unconfined.empty())
    console.say(fmt::format(
        "  note: the release sees files and network like any program of yours, because {}", unconfined));
  return source;
}

int runOnTwin(const scenario::Case& test_case, const judge::RunOptions& options, base::Stopwatch& stopwatch,
              base::Console& console) {
  const scenario::Scenario& scenario = test_case.scenario;
  const twin::SampledMachine sampled = scenario::sampledMachine(test_case);
  run::PreparedJob job = run::prepareJob(test_case);
  console.say("  " + job.summary);
  console.expect(job.expected_s);
  stopwatch.lap("reading and planning");

  const auto source = openTold(scenario.firmware, options, console);
  const source::SourceInfo info = source->info();
  const std::string firmware =
      fmt::format("{} ({})", scenario.firmware.image.filename().string(), sourceName(scenario.firmware));
  const std::unique_ptr<trace::RunTrace> traced =
      trace::tracing({test_case,
                      sampled.machine,
                      info.rate,
                      scenario.name,
                      firmware,
                      info.config_id,
                      {job.gcode, trace::ProgramOrigin::kSent, run::programPeriod_s(job)}},
                     options, console);
  run::ModelOptions model = run::modelOptions(test_case);
  model.onlooker = traced.get();
  run::ModelMachine machine(test_case, sampled, info.rate, model);
  const std::unique_ptr<judge::SpotWatch> spot_watch =
      judge::SpotWatch::of(test_case, machine, info.rate, options.jobs);
  const std::unique_ptr<judge::KerfWatch> kerf_watch = judge::KerfWatch::of(test_case, machine, options.jobs);
  run::LockstepOptions lockstep = run::lockstepFor(test_case);
  lockstep.heard = judge::heardBy(spot_watch.get());
  const bool provoked = scenario.provoke.cause != scenario::ProvokeChoice::Cause::kNone;
  run::Provocation provocation(scenario.provoke, info.rate, scenario.seed);
  if (provoked) {
    lockstep.provocation = &provocation;
    lockstep.settle_s = kSettleAfterStop_s;
  }
  run::RecordedRun run = machine.run(*source, job.dialog.get(), lockstep, base::progressOn(console));
  if (provoked) console.say("  " + job.dialog->message());
  run::tellRemarks(job, console);
  stopwatch.lap(spot_watch ? "firmware and machine, cameras beside them" : "firmware and machine");

  judge::Conclusion conclusion;
  conclusion.folder_name = scenario.name;
  conclusion.firmware = firmware;
  conclusion.finish_trace = trace::finishing(traced.get(), options, console);
  conclusion.source_id = info.config_id;
  conclusion.sampled = &sampled;
  conclusion.machine = &machine;
  conclusion.spot_watch = spot_watch.get();
  conclusion.kerf_watch = kerf_watch.get();
  conclusion.firmware_sha256 = base::sha256File(scenario.firmware.image);
  conclusion.firmware_version = std::move(job.controller);
  conclusion.gcode = std::move(job.gcode);
  if (job.dialog) conclusion.remarks = job.dialog->remarks();
  judge::collectControllerEvidence(test_case, job, run.recording, provocation.lineCut_s(), run, conclusion);
  return judge::conclude(test_case, run, conclusion, options, stopwatch, console);
}

int runOne(const fs::path& path, const fs::path& image, const judge::RunOptions& options) {
  base::Stopwatch stopwatch;
  base::Console console =
      cli::forOption("--events", [&] { return base::Console(options.quiet, options.events); });
  console.beVerbose(options.verbose);
  scenario::Case test_case = caseWithOptions(path, image, options, console);
  const scenario::Scenario& scenario = test_case.scenario;
  judge::refuseBlockedRuns(options.results_dir, scenario.name, options.output);
  console.say(fmt::format("{}: {}", scenario.name, scenario.title));
  console.event("scenario", {{"name", scenario.name}, {"title", scenario.title}});
  live::refuseKerfPictures(test_case);
  if (const auto code = refusedByWitness(test_case, scenario.name, options, stopwatch, console)) return *code;
  if (scenario.firmware.onRealPins())
    return live::runOnPins(test_case, live::realPins(options.bin_dir), options, stopwatch, console);
  live::refuseRealCamera(test_case);
  run::refuseUnfitController(test_case, options.bin_dir);
  return runOnTwin(test_case, options, stopwatch, console);
}

}  // namespace

int runCommand(const std::vector<fs::path>& scenarios, const fs::path& image,
               const judge::RunOptions& options) {
  int code = 0;
  for (const fs::path& scenario : scenarios) {
    code = base::worstExitCode(code,
                               cli::runGuarded(scenario, [&] { return runOne(scenario, image, options); }));
  }
  return code;
}

int replayCommand(const Replay& replay, const judge::RunOptions& options) {
  return cli::runGuarded(replay.scenario, [&] {
    if (!cli::isStandardInput(replay.recording)) return replayOne(replay, replay.recording.string(), options);
    const cli::InputAsFile file;
    Replay piped = replay;
    piped.recording = file.path();
    try {
      return replayOne(piped, cli::kStandardInputName, options);
    } catch (const base::InputError& error) {
      throw base::InputError(cli::withInputNamed(error.what(), file.path()));
    }
  });
}

}  // namespace kerfbench::app
