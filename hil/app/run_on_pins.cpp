// SPDX-License-Identifier: Apache-2.0
#include "hil/app/run_on_pins.h"

#include <fmt/format.h>

#include <limits>
#include <utility>
#include <vector>

#include "hil/app/cut_on_twin.h"
#include "hil/app/dialogs.h"
#include "hil/app/hear_controller.h"
#include "hil/app/kept_evidence.h"
#include "hil/app/live_pins.h"
#include "hil/app/live_spot.h"
#include "hil/app/machine_film.h"
#include "hil/app/model_parting.h"
#include "hil/app/sensor_lag.h"
#include "hil/source/open.h"

namespace kerfbench::hil {
namespace {

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
  if (found.switch_lag.edges() > 0)
    console.say(fmt::format(
        "  {} edges of limit switches, which answer to pins: at worst {:.1f} ms off the machine's",
        found.switch_lag.edges(), 1e-6 * static_cast<double>(found.switch_lag.worst_ns())));
  run.problems.insert(run.problems.end(), found.problems.begin(), found.problems.end());
}

}  // namespace

int judgeRecorded(const Case& the_case, const twin::DrawnMachine& drawn, const PinRecording& recorded,
                  Conclusion conclusion, const CommonOptions& options, Stopwatch& stopwatch,
                  Console& console) {
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
  }
  return conclude(the_case, twin, run, conclusion, options, stopwatch, console);
}

int runOnPins(const Case& the_case, const RealPins& pins, const CommonOptions& options, Stopwatch& stopwatch,
              Console& console) {
  refuseKerfPictures(the_case);
  const FirmwareChoice& firmware = the_case.scenario.firmware;
  const twin::DrawnMachine drawn = drawnMachine(the_case);
  PreparedJob job = prepareJob(the_case);
  console.say("  " + job.summary);
  stopwatch.lap("reading and planning");
  Conclusion conclusion;
  conclusion.folder_name = the_case.scenario.name;
  conclusion.firmware = "real pins of " + pinsName(firmware);
  LiveSpot spot(the_case, options.results_dir, console);
  PinRecording recorded;
  std::string driven;
  if (firmware.gpio.isLive()) {
    LivePins live = runLive(the_case, drawn, pins, job, console);
    driven = "; " + drivenWords(live);
    conclusion.firmware_version = std::move(job.controller);
    conclusion.gcode = std::move(job.gcode);
    recorded = std::move(live.captured.recording);
  } else {
    recorded = hearPins(the_case, pins, console).recording;
  }
  conclusion.source_id = fmt::format("{}, stamps within {:.4g} us{}", pinsName(firmware),
                                     1e6 * recorded.rate.seconds(recorded.stamp_err_ticks), driven);
  try {
    spot.finish(conclusion, console);
    stopwatch.lap("real pins");
    return judgeRecorded(the_case, drawn, recorded, std::move(conclusion), options, stopwatch, console);
  } catch (...) {
    keepEvidence(the_case, recorded, spot.frames(), options.results_dir, console);
    throw;
  }
}

}  // namespace kerfbench::hil
