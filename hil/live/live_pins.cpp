// SPDX-License-Identifier: Apache-2.0
#include "hil/live/live_pins.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "hil/judge/controller_evidence.h"
#include "hil/live/pin_capture.h"
#include "hil/live/pin_watch.h"
#include "hil/run/live_model.h"
#include "hil/run/lockstep.h"
#include "hil/run/release.h"
#include "hil/scenario/gpio_choice.h"
#include "hil/scenario/pul_axes.h"
#include "hil/source/gpio/live_source.h"

namespace kerfbench::live {
namespace {

bool wantsLimits(const scenario::Case& test_case) {
  return test_case.machine.kind == twin::MachineDescription::Kind::kGantry &&
         std::ranges::any_of(test_case.scenario.firmware.gpio.outputs, [](const scenario::PinLine& line) {
           return line.signal == Signal::kLimitX || line.signal == Signal::kLimitY;
         });
}

void waitFor(double time_s, source::GpioSystem& system) {
  const std::uint64_t end_ns = system.now_ns() + static_cast<std::uint64_t>(1e9 * time_s);
  for (std::uint64_t now_ns = system.now_ns(); now_ns < end_ns; now_ns = system.now_ns()) {
    short none = 0;
    (void)system.poll(-1, end_ns - now_ns, none);
  }
}

std::unique_ptr<source::SerialLine> openUart(const scenario::FirmwareChoice& firmware, const RealPins& pins) {
  if (firmware.gpio.uart.empty()) return nullptr;
  try {
    auto line = std::make_unique<source::SerialLine>(pins.serial, firmware.gpio.uart, firmware.baud);
    waitFor(firmware.gpio.uart_wait_s, *pins.gpio);
    return line;
  } catch (const source::SerialError& e) {
    throw source::SerialError(fmt::format("{}: {}", firmware.gpio.uart_place, e.what()));
  }
}

void announce(const source::GpioLiveOptions& live, const scenario::FirmwareChoice& firmware,
              base::Console& console) {
  console.say(fmt::format("  live: reading {} lines of {}, driving {}{}", live.in.wires.size(),
                          live.in.chip.string(), live.out.size(),
                          live.out.empty() ? "" : " of " + live.out_chip.string()));
  console.say(
      live.ends_when_quiet
          ? fmt::format("  start the job: the sheet is on its way; it is over when the pins are quiet "
                        "for {} s",
                        live.in.quiet_s)
          : fmt::format("  talking to the controller on {}", firmware.gpio.uart));
  console.event("operator",
                {{"text", live.ends_when_quiet ? "Start the job at the machine: the sheet is on its way."
                                               : "Keep clear of the machine: it gets its job from here."}});
}

/// Pins, sensors and words of the run in one recording.
source::PinCapture captureOf(run::RecordedRun& run, source::GpioLiveRecord& record,
                             std::uint32_t stamp_err_ticks, std::uint16_t heard_port) {
  source::PinCapture captured;
  captured.recording = std::move(run.recording);
  source::PinRecording& recording = captured.recording;
  recording.stamp_err_ticks = stamp_err_ticks;
  recording.sensors = base::SpilledVector<SensorEdge>(record.sensors);
  recording.uart = std::move(record.uart);
  captured.notes = std::move(record.notes);
  captured.edges = record.edges;
  recording.problems.insert(recording.problems.end(), std::make_move_iterator(record.problems.begin()),
                            std::make_move_iterator(record.problems.end()));
  source::spoilEnd(recording, heard_port);
  return captured;
}

/// A replay has no dialog: what it leaves unproven is the recording's to say.
void tellUnproven(const scenario::Case& test_case, run::RecordedRun& run, source::PinRecording& recording) {
  run.problems = recording.problems;
  const std::string unproven = judge::unprovenDialog(test_case, recording, run);
  if (!unproven.empty()) recording.problems.push_back(unproven);
}

}  // namespace

std::string drivenWords(const LivePins& live) {
  std::string words =
      fmt::format("{} edges driven, at worst {:.1f} us behind their plan, {:.1f} us rms", live.lag.edges(),
                  1e-3 * static_cast<double>(live.lag.worst_ns()), 1e-3 * live.lag.rms_ns());
  if (live.switch_lag.edges() > 0)
    words += fmt::format("; {} of limit switches, which answer to pins, at worst {:.1f} ms behind",
                         live.switch_lag.edges(), 1e-6 * static_cast<double>(live.switch_lag.worst_ns()));
  return words;
}

LivePins runLive(const scenario::Case& test_case, const twin::SampledMachine& sampled, const RealPins& pins,
                 const run::PreparedJob& job, base::Console& console) {
  const scenario::Scenario& scenario = test_case.scenario;
  try {
    source::GpioLiveOptions options = scenario::liveOptions(scenario.firmware.gpio, pins.chips());
    options.in.at_start = scenario::startLevels(test_case.machine);
    options.ends_when_quiet = job.dialog == nullptr;
    run::LiveModel model(sampled.machine, scenario::webOn(sampled.machine, test_case),
                         source::GpioLiveSource::kRate, scenario.seed, wantsLimits(test_case));
    options.high_at_start = model.highAtStart();
    // First, because opening it can make a board start anew, with all that its pins do then.
    std::unique_ptr<source::SerialLine> uart = openUart(scenario.firmware, pins);
    source::GpioLiveSource source(options, test_case.machine.signals, pins.gpio, std::move(uart));
    announce(options, scenario.firmware, console);
    PinWatch watch(test_case.machine.signals, source::GpioLiveSource::kRate, console.events());
    run::LockstepOptions lockstep;
    lockstep.time_limit_s = scenario.time_limit_s;
    if (watch.isWatched())
      lockstep.heard = [&watch, &source](Tick until, std::span<const PinEvent> events) {
        watch.heard(until, events);
        watch.lagged(source.worstLag_ns());
      };
    // Without progress on the terminal: writing there can take longer than a quantum.
    run::RecordedRun run =
        run::runLockstep(source, model, test_case.machine.signals, job.dialog.get(), lockstep, {});
    run.recording.end = std::max<Tick>(run.recording.end, 1);
    source::GpioLiveRecord record = source.finish(run.recording.end);
    LivePins live;
    live.lag = record.lag;
    live.switch_lag = record.switch_lag;
    live.captured = captureOf(run, record, source.info().stamp_err_ticks,
                              source::pinsOf(options.in.wires, test_case.machine.signals).front().port);
    tellUnproven(test_case, run, live.captured.recording);
    for (const std::string& note : live.captured.notes) console.say("  " + note);
    console.say(fmt::format("  {} edges read in {:.3f} s; {}", live.captured.edges,
                            source::GpioLiveSource::kRate.seconds(live.captured.recording.end),
                            drivenWords(live)));
    return live;
  } catch (const source::GpioError& e) {
    throw base::InputError(e.what());
  } catch (const source::SerialError& e) {
    throw base::InputError(e.what());
  }
}

}  // namespace kerfbench::live
