// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>

#include "hil/app/commands.h"
#include "hil/app/conclude.h"
#include "hil/app/dialogs.h"
#include "hil/base/digest.h"
#include "hil/base/yaml_reader.h"
#include "hil/source/open.h"

namespace kerfbench::hil {
namespace {

namespace fs = std::filesystem;

// Events in a quantum of 0.5 ms that no controller of a die-cutter makes: 2 million a second, 20 times what
// the reference controller makes with all axes at full speed.
constexpr std::uint64_t kFlood = 1000;

// A release image or a recording that cannot be used.
struct InputFault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::string sourceName(FirmwareChoice::Source source) {
  switch (source) {
    case FirmwareChoice::Source::kAvr:
      return "AVR emulator";
    case FirmwareChoice::Source::kNative:
      return "native build";
    case FirmwareChoice::Source::kChild:
      break;
  }
  return "child process";
}

std::unique_ptr<SignalSource> openRelease(const FirmwareChoice& firmware, const fs::path& bin_dir) {
  ChildSourceOptions options;
  options.image = firmware.image;
  // A native release is itself the child that speaks the protocol.
  options.child = firmware.source == FirmwareChoice::Source::kAvr      ? bin_dir / "kerfbench-avr"
                  : firmware.source == FirmwareChoice::Source::kNative ? firmware.image
                                                                       : firmware.child;
  options.mcu = firmware.mcu;
  options.clock_hz = firmware.clock_hz;
  options.baud = firmware.baud;
  options.max_events_per_quantum = kFlood;
  try {
    return openChild(options);
  } catch (const std::runtime_error& e) {
    throw InputFault(fmt::format("{}: {}", firmware.image.string(), e.what()));
  }
}

Case caseWithOptions(const fs::path& path, const CommonOptions& options) {
  Case the_case = readCase(path, options.bin_dir.parent_path() / "firmware");
  if (options.seed) the_case.scenario.seed = *options.seed;
  if (options.time_limit_s) the_case.scenario.time_limit_s = *options.time_limit_s;
  return the_case;
}

ProgressFn progressOn(Console& console) {
  return [&console](double now_s, const std::string& what) { console.progress(now_s, what); };
}

int runOne(const fs::path& path, const CommonOptions& options) {
  Stopwatch stopwatch;
  Console console(options.quiet);
  const Case the_case = caseWithOptions(path, options);
  const Scenario& scenario = the_case.scenario;
  console.say(fmt::format("{}: {}", scenario.name, scenario.title));
  PreparedJob job = prepareJob(the_case);
  console.say("  " + job.summary);
  stopwatch.lap("reading and planning");

  const auto source = openRelease(scenario.firmware, options.bin_dir);
  const SourceInfo info = source->info();
  twin::Twin twin(the_case.machine, webOf(the_case), info.rate);
  LockstepOptions lockstep;
  lockstep.time_limit_s = scenario.time_limit_s;
  const LockstepResult run =
      runLockstep(*source, twin, the_case.machine.signals, job.dialog.get(), lockstep, progressOn(console));
  stopwatch.lap("firmware and machine");

  Conclusion conclusion;
  conclusion.folder_name = scenario.name;
  conclusion.firmware = fmt::format("{} ({})", scenario.firmware.image.filename().string(),
                                    sourceName(scenario.firmware.source));
  conclusion.source_id = info.config_id;
  conclusion.firmware_sha256 = sha256File(scenario.firmware.image);
  conclusion.gcode = std::move(job.gcode);
  return conclude(the_case, twin, run, conclusion, options, stopwatch, console);
}

int replayOne(const fs::path& recording, const fs::path& scenario, const CommonOptions& options) {
  Stopwatch stopwatch;
  Console console(options.quiet);
  const Case the_case = caseWithOptions(scenario, options);
  console.say(fmt::format("{}: {}, replayed from {}", the_case.scenario.name, the_case.scenario.title,
                          recording.string()));
  std::unique_ptr<SignalSource> source;
  try {
    source = openVcd(recording, the_case.machine.signals);
  } catch (const std::runtime_error& e) {
    throw InputFault(e.what());
  }
  stopwatch.lap("reading");

  const SourceInfo info = source->info();
  twin::Twin twin(the_case.machine, webOf(the_case), info.rate);
  LockstepOptions lockstep;
  lockstep.time_limit_s = the_case.scenario.time_limit_s;
  const LockstepResult run =
      runLockstep(*source, twin, the_case.machine.signals, nullptr, lockstep, progressOn(console));
  stopwatch.lap("machine");

  Conclusion conclusion;
  conclusion.folder_name = the_case.scenario.name + "-replay";
  conclusion.firmware = "recording " + recording.filename().string();
  conclusion.source_id = info.config_id;
  return conclude(the_case, twin, run, conclusion, options, stopwatch, console);
}

// Bad input of the user, told in his words, with its exit code.
int guarded(const std::function<int()>& work) {
  try {
    return work();
  } catch (const ConfigError& e) {
    std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
  } catch (const DielineError& e) {
    std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
  } catch (const planner::PlanError& e) {
    std::fputs(fmt::format("the job cannot be planned: {}\n", e.what()).c_str(), stderr);
  } catch (const InputFault& e) {
    std::fputs(fmt::format("{}\n", e.what()).c_str(), stderr);
  }
  return kExitInput;
}

// Of several runs the gravest counts.
int gravest(int a, int b) {
  constexpr std::array kGravity{0, 4, 1, 3, kExitInput, kExitBroken};
  const auto rank = [&](int code) { return std::ranges::find(kGravity, code) - kGravity.begin(); };
  return rank(a) >= rank(b) ? a : b;
}

}  // namespace

int runCommand(const std::vector<fs::path>& scenarios, const CommonOptions& options) {
  int code = 0;
  for (const fs::path& scenario : scenarios) {
    code = gravest(code, guarded([&] { return runOne(scenario, options); }));
  }
  return code;
}

int replayCommand(const fs::path& recording, const fs::path& scenario, const CommonOptions& options) {
  return guarded([&] { return replayOne(recording, scenario, options); });
}

}  // namespace kerfbench::hil
