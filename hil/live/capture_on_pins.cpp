// SPDX-License-Identifier: Apache-2.0
#include "hil/live/capture_on_pins.h"

#include <fmt/format.h>

#include <exception>

#include "hil/base/atomic_file.h"
#include "hil/base/exit_codes.h"
#include "hil/base/yaml_reader.h"
#include "hil/inspect/verdict/verdict.h"
#include "hil/judge/results_folder.h"
#include "hil/live/pin_statistics.h"
#include "hil/live/real_pins.h"
#include "hil/run/release.h"
#include "hil/source/analyser/sr_file.h"
#include "hil/source/pin_capture.h"
#include "hil/source/vcd.h"

namespace kerfbench::live {
namespace {

namespace fs = std::filesystem;

/// Check before the capture, whose recording is cut out of the time limit, with a tail.
void requireRoomForSession(const scenario::Scenario& scenario) {
  const std::uint64_t rate_hz = scenario.firmware.analyser.samplerate_hz;
  const double most_samples =
      (scenario.time_limit_s + source::kTailAfterEdges_s) * static_cast<double>(rate_hz) + 3.0;
  if (most_samples < static_cast<double>(source::kMostSrSamples)) return;
  throw base::InputError(
      fmt::format("{}: --sr: {:g} s at {} Hz may be more samples than a session file holds (2^36): a shorter "
                  "--time-limit, or do without --sr",
                  scenario.path.string(), scenario.time_limit_s, rate_hz));
}

scenario::Case readPinCase(const CaptureOptions& options) {
  scenario::Case test_case = scenario::readCase(options.scenario, options.bin_dir.parent_path() / "firmware");
  if (!test_case.scenario.firmware.onRealPins()) {
    throw base::ConfigError(fmt::format(
        "{}: firmware.source: nothing to capture: the pins are no real ones (source: gpio, analyser)",
        test_case.scenario.path.string()));
  }
  if (options.session && test_case.scenario.firmware.source == scenario::FirmwareChoice::Source::kGpio) {
    throw base::InputError(
        fmt::format("{}: --sr is for an analyser's samples (source: analyser): edges of a gpiochip, stamped "
                    "in ns, have no "
                    "sample rate",
                    test_case.scenario.path.string()));
  }
  if (options.time_limit_s) test_case.scenario.time_limit_s = *options.time_limit_s;
  if (options.session) requireRoomForSession(test_case.scenario);
  return test_case;
}

/// Reason why there is none, or empty. The job is over, so the rest of the capture is kept.
std::string writeSession(const fs::path& path, const source::PinRecording& recording, const SignalMap& map) {
  try {
    source::writeSr(path, recording, map);
    return {};
  } catch (const std::exception& e) {
    return e.what();
  }
}

/// The folder as a whole is put in place, so what else there is would go.
fs::path outFolder(const CaptureOptions& options, const std::string& name) {
  const fs::path wanted = options.out.empty() ? fs::path("results") / (name + "-capture") : options.out;
  fs::path out = fs::absolute(wanted).lexically_normal();
  if (out.filename().empty()) out = out.parent_path();
  judge::refuseForeignResults(out.parent_path(), out.filename().string());
  return out;
}

}  // namespace

int captureOnPins(const RealPins& pins, const CaptureOptions& options) {
  base::Console console(options.quiet);
  const scenario::Case test_case = readPinCase(options);
  const std::string& name = test_case.scenario.name;
  console.say(fmt::format("{}: {}", name, test_case.scenario.title));
  // Check before the capture: whoever has started a job wants to keep it.
  const fs::path out = outFolder(options, name);
  judge::ResultsFolder folder(out.parent_path(), out.filename().string());
  const bool has_camera = test_case.scenario.cameras.spot.is_real;
  if (has_camera)
    console.say(
        "  the spot camera is real and not recorded here: `kerfbench record-frames` beside this does, or "
        "`run` both");

  const source::PinCapture captured = hearPins(test_case, pins, console);
  const source::PinRecording& recording = captured.recording;
  source::writeVcd(folder.staging() / "pins.vcd", recording, test_case.machine.signals);
  base::writeFileAtomically(folder.staging() / "scenario.yaml", test_case.scenario.text);
  std::string no_session;
  if (options.session)
    no_session = writeSession(folder.staging() / "pins.sr", recording, test_case.machine.signals);
  folder.commit();

  console.say(pinStatisticsText(pinStatistics(recording, test_case.machine.signals)));
  for (const std::string& problem : recording.problems) console.result("  INVALID: " + problem);
  const fs::path vcd = folder.place() / "pins.vcd";
  console.say(fmt::format("recording: {}\njudge it: ./bench replay {} --scenario {}{}", vcd.string(),
                          vcd.string(), options.scenario.string(), has_camera ? " --frames FOLDER" : ""));
  const int code = recording.problems.empty() ? 0 : inspect::exitCode(inspect::Verdict::kInvalid);
  if (no_session.empty()) return code;
  console.result(fmt::format("  no pins.sr: {}", no_session));
  return base::worstExitCode(code, base::kExitBroken);
}

}  // namespace kerfbench::live
