// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "hil/app/commands.h"
#include "hil/app/conclude.h"
#include "hil/app/cut_on_twin.h"
#include "hil/app/dialogs.h"
#include "hil/app/exit_codes.h"
#include "hil/app/hear_controller.h"
#include "hil/app/live_spot.h"
#include "hil/app/machine_film.h"
#include "hil/app/real_pins.h"
#include "hil/app/recording_file.h"
#include "hil/app/release.h"
#include "hil/app/run_on_pins.h"
#include "hil/base/digest.h"
#include "hil/base/yaml_reader.h"

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

constexpr double kSettleAfterStop_s = 0.5;  // for a controller that might go on by itself

int replayOne(const fs::path& recording, const fs::path& scenario, const fs::path& frames,
              const CommonOptions& options) {
  Stopwatch stopwatch;
  Console console(options.quiet);
  const Case the_case = caseWithOptions(scenario, options);
  console.say(fmt::format("{}: {}, replayed from {}", the_case.scenario.name, the_case.scenario.title,
                          recording.string()));
  const twin::DrawnMachine drawn = drawnMachine(the_case);
  PinRecording recorded;
  Conclusion conclusion;
  try {
    recorded = readRecording(recording, the_case);
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
  refuseKerfPictures(the_case);
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
