// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/analyser_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/add_to_list.h"
#include "hil/scenario/pul_axes.h"

namespace kerfbench::scenario {
namespace {

/// The shortest time that a drive's PUL keeps a level, by its data sheet; 0: it does not say.
double shortestPulse_s(const DriverProfile& profile) {
  if (profile.width_s <= 0.0 || profile.space_s <= 0.0) return std::max(profile.width_s, profile.space_s);
  return std::min(profile.width_s, profile.space_s);
}

}  // namespace

AnalyserChoice readAnalyserChoice(base::YamlReader& firmware) {
  AnalyserChoice choice;
  choice.driver = firmware.text("driver");
  choice.place = firmware.placeOf("firmware.driver") + ": firmware.driver";
  choice.conn = firmware.text("conn", "");
  choice.serial = firmware.text("serial", "");
  choice.samplerate_hz =
      static_cast<std::uint64_t>(firmware.integer("samplerate_hz", {.min = 1e3, .max = 1e10}));
  choice.rate_place = firmware.placeOf("firmware.samplerate_hz") + ": firmware.samplerate_hz";
  choice.settings = firmware.pairs("settings");
  choice.quiet_s = readQuiet_s(firmware);
  choice.lines = readPinLines(firmware);
  return choice;
}

std::vector<SlowRate> tooSlowFor(const twin::MachineDescription& machine, std::uint64_t samplerate_hz) {
  std::vector<SlowRate> slow;
  for (const auto& [pul, axis] : pulAxes(machine)) {
    const double pulse_s = shortestPulse_s(axis->profile);
    // Not a whole hertz more for the rounding of a quotient.
    const double least_hz = pulse_s > 0.0 ? std::ceil((1.0 - 1e-12) * kLeastSamples / pulse_s) : 0.0;
    if (!machine.signals.pin(pul) || static_cast<double>(samplerate_hz) >= least_hz) continue;
    slow.push_back(
        {pul,
         fmt::format("{} Hz is too low for {}: its drive ({}) takes pulses of {:.4g} us, and {} samples of "
                     "each need at least {:.0f} Hz",
                     samplerate_hz, signalName(pul), axis->profile.name, 1e6 * pulse_s, kLeastSamples,
                     least_hz)});
  }
  return slow;
}

std::string faultsOf(const AnalyserChoice& choice, const twin::MachineDescription& machine) {
  std::string faults = faultsOf(choice.lines, choice.place, machine.signals,
                                machine.kind == twin::MachineDescription::Kind::kGantry);
  for (const SlowRate& slow : tooSlowFor(machine, choice.samplerate_hz)) {
    if (std::ranges::find(choice.lines, slow.pul, &PinLine::signal) != choice.lines.end())
      base::addToList(faults, choice.rate_place + ": " + slow.words);
  }
  return faults;
}

source::AnalyserCaptureOptions captureOptions(const AnalyserChoice& choice) {
  source::AnalyserCaptureOptions options;
  options.request.driver = choice.driver;
  options.request.conn = choice.conn;
  options.request.serial = choice.serial;
  options.request.samplerate_hz = choice.samplerate_hz;
  options.request.settings = choice.settings;
  for (const PinLine& line : choice.lines) {
    options.request.channels.push_back(line.line);
    options.signals.push_back(line.signal);
  }
  options.quiet_s = choice.quiet_s;
  return options;
}

}  // namespace kerfbench::scenario
