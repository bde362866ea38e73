// SPDX-License-Identifier: Apache-2.0
#include "hil/scenario/gpio_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <utility>

#include "hil/base/add_to_list.h"

namespace kerfbench::scenario {
namespace {

std::string firmwarePlace(const base::YamlReader& firmware, const std::string& key) {
  return firmware.placeOf("firmware." + key) + ": firmware." + key;
}

/// The lines of one section: those of the controller's outputs, or of its inputs.
std::vector<PinLine> readLines(base::YamlReader& firmware, const char* section, bool sensors) {
  std::vector<PinLine> chosen;
  base::YamlReader lines = firmware.section(section);
  std::map<std::string, std::string_view> users;
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    const std::string_view name = signalName(signal);
    if (!lines.has(name)) continue;
    const std::string line = lines.text(name);
    if (isSensor(signal) && !sensors) {
      lines.fault(name,
                  "is an input of the controller: it belongs to firmware.outputs, which the bench drives "
                  "(source: gpio)");
    } else if (!isSensor(signal) && sensors) {
      lines.fault(name, "is an output of the controller: it belongs to firmware.lines");
    } else if (signal == Signal::kPowerMonitor) {
      lines.fault(
          name,
          "cannot be driven: the model knows what the laser did 21 ms later, and a power meter answers "
          "sooner");
    } else if (signal == Signal::kStart) {
      lines.fault(name, "is pressed by hand on real pins");
    } else if (const auto [user, is_new] = users.emplace(line, name); !is_new) {
      lines.fault(name, fmt::format("has line {}, and so has {}", line, user->second));
    } else {
      chosen.push_back({signal, line, firmwarePlace(firmware, fmt::format("{}.{}", section, name))});
    }
  }
  return chosen;
}

void addUnknown(const std::vector<PinLine>& lines, const SignalMap& machine, std::string& faults) {
  for (const PinLine& line : lines) {
    if (!machine.pin(line.signal)) {
      base::addToList(faults, line.place + ": the machine has no such pin");
    } else if (!machine.hasOwnWire(line.signal)) {
      base::addToList(faults, line.place +
                                  ": the machine has this pin for another enable as well; name the "
                                  "line of the first of them alone");
    }
  }
}

void addMissing(const char* section, const std::vector<PinLine>& lines, std::span<const Signal> wanted,
                const std::string& place, const SignalMap& machine, std::string& faults) {
  for (const Signal signal : wanted) {
    if (!machine.hasOwnWire(signal) || std::ranges::find(lines, signal, &PinLine::signal) != lines.end())
      continue;
    base::addToList(faults, fmt::format("{}: firmware.{} has no line for {}, which the machine has", place,
                                        section, signalName(signal)));
  }
}

template <typename Find>
auto foundAt(const std::string& place, const Find& find) {
  try {
    return find();
  } catch (const source::GpioError& e) {
    throw source::GpioError(place + ": " + e.what());
  }
}

/// Lines of one chip and who has them, for both directions.
using LineUsers = std::map<std::pair<std::string, std::uint32_t>, Signal>;

std::vector<source::GpioWire> wiresOf(const std::vector<PinLine>& lines, const source::GpioChipInfo& chip,
                                      LineUsers& users, std::string& faults) {
  std::vector<source::GpioWire> wires;
  for (const PinLine& line : lines) {
    try {
      const std::uint32_t offset =
          foundAt(line.place, [&] { return source::findLine(chip, line.line).offset; });
      const auto [user, is_new] = users.emplace(std::pair(chip.path.string(), offset), line.signal);
      if (!is_new)
        base::addToList(faults, fmt::format("{}: is line {}, and so is {}", line.place, offset,
                                            signalName(user->second)));
      wires.push_back({line.signal, offset});
    } catch (const source::GpioError& e) {
      base::addToList(faults, e.what());
    }
  }
  return wires;
}

}  // namespace

GpioChoice readGpioChoice(base::YamlReader& firmware) {
  GpioChoice choice;
  choice.chip = firmware.text("chip");
  choice.place = firmwarePlace(firmware, "chip");
  choice.stamp_err_s = 1e-6 * firmware.number("stamp_err_us", {.min = 0.001, .max = 1e4});
  choice.quiet_s = readQuiet_s(firmware);
  choice.lines = readPinLines(firmware);
  choice.outputs = readLines(firmware, "outputs", true);
  choice.out_chip = firmware.text("out_chip", choice.chip);
  choice.out_place = firmware.has("out_chip") ? firmwarePlace(firmware, "out_chip") : choice.place;
  if (firmware.has("max_lag_us"))
    choice.max_lag_s = 1e-6 * firmware.number("max_lag_us", {.min = 1, .max = 1e5});
  choice.uart = firmware.text("uart", "");
  choice.uart_place = firmwarePlace(firmware, "uart");
  choice.uart_wait_s = firmware.number("uart_wait_s", {.min = 0, .max = 30, .fallback = 0.0});
  choice.uart_delay_s = 1e-3 * firmware.number("uart_delay_ms", {.min = 0, .max = 1000, .fallback = 20.0});
  if (choice.outputs.empty()) {
    for (const char* key : {"out_chip", "max_lag_us"}) {
      if (firmware.has(key)) firmware.fault(key, "belongs to firmware.outputs, which are not there");
    }
  }
  return choice;
}

double readQuiet_s(base::YamlReader& firmware) {
  return firmware.number("quiet_s", {.min = 0.5, .max = 60, .fallback = 2.0});
}

std::vector<PinLine> readPinLines(base::YamlReader& firmware) { return readLines(firmware, "lines", false); }

std::string faultsOf(const std::vector<PinLine>& lines, const std::string& place, const SignalMap& machine,
                     bool gantry) {
  static constexpr std::array kAlways{Signal::kLaserGate,    Signal::kLaserPwm,      Signal::kGalvoXEnable,
                                      Signal::kGalvoYEnable, Signal::kGantryXEnable, Signal::kGantryYEnable,
                                      Signal::kFeedEnable};
  static constexpr std::array kGantry{Signal::kGantryXPul, Signal::kGantryXDir, Signal::kGantryYPul,
                                      Signal::kGantryYDir};
  static constexpr std::array kGalvos{Signal::kGalvoXPul, Signal::kGalvoXDir, Signal::kGalvoYPul,
                                      Signal::kGalvoYDir};
  std::string faults;
  addUnknown(lines, machine, faults);
  addMissing("lines", lines, kAlways, place, machine, faults);
  addMissing("lines", lines, gantry ? kGantry : kGalvos, place, machine, faults);
  return faults;
}

std::string faultsOf(const GpioChoice& choice, const SignalMap& machine, const WiringNeeds& needs) {
  std::string faults = faultsOf(choice.lines, choice.place, machine, needs.gantry);
  addUnknown(choice.outputs, machine, faults);
  static constexpr std::array kOfSheet{Signal::kEncoderA, Signal::kEncoderB, Signal::kPrintMark};
  if (needs.moving_sheet) addMissing("outputs", choice.outputs, kOfSheet, choice.place, machine, faults);
  return faults;
}

source::GpioCaptureOptions captureOptions(const GpioChoice& choice, const source::GpioChipList& chips) {
  GpioChoice inputs_alone = choice;
  inputs_alone.outputs.clear();
  return liveOptions(inputs_alone, chips).in;
}

source::GpioLiveOptions liveOptions(const GpioChoice& choice, const source::GpioChipList& chips) {
  source::GpioLiveOptions options;
  options.in.stamp_err_s = choice.stamp_err_s;
  options.in.quiet_s = choice.quiet_s;
  const source::GpioChipInfo* const chip =
      foundAt(choice.place, [&] { return &source::findChip(chips, choice.chip); });
  options.in.chip = chip->path;
  std::string faults;
  LineUsers users;
  options.in.wires = wiresOf(choice.lines, *chip, users, faults);
  if (!choice.outputs.empty()) {
    const source::GpioChipInfo* const out =
        foundAt(choice.out_place, [&] { return &source::findChip(chips, choice.out_chip); });
    options.out_chip = out->path;
    options.out = wiresOf(choice.outputs, *out, users, faults);
  }
  if (!faults.empty()) throw source::GpioError(faults);
  return options;
}

}  // namespace kerfbench::scenario
