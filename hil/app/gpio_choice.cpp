// SPDX-License-Identifier: Apache-2.0
#include "hil/app/gpio_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace kerfbench::hil {
namespace {

void addLine(std::string& text, const std::string& line) { text += (text.empty() ? "" : "\n") + line; }

std::string placeOf(const YamlReader& firmware, const std::string& key) {
  return firmware.placeOf("firmware." + key) + ": firmware." + key;
}

}  // namespace

GpioChoice readGpioChoice(YamlReader& firmware) {
  GpioChoice choice;
  choice.chip = firmware.text("chip");
  choice.place = placeOf(firmware, "chip");
  choice.stamp_err_s = 1e-6 * firmware.number("stamp_err_us", {.min = 0.001, .max = 1e4});
  choice.quiet_s = readQuiet_s(firmware);
  choice.lines = readPinLines(firmware);
  return choice;
}

double readQuiet_s(YamlReader& firmware) {
  return firmware.number("quiet_s", {.min = 0.5, .max = 60, .fallback = 2.0});
}

std::vector<PinLine> readPinLines(YamlReader& firmware) {
  std::vector<PinLine> read;
  YamlReader lines = firmware.section("lines");
  std::map<std::string, std::string_view> users;
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    const std::string_view name = signalName(signal);
    if (!lines.has(name)) continue;
    const std::string line = lines.text(name);
    if (isSensor(signal)) {
      lines.fault(name, "is an input of the controller, and the bench does not drive pins yet");
    } else if (const auto [user, is_new] = users.emplace(line, name); !is_new) {
      lines.fault(name, fmt::format("has line {}, and so has {}", line, user->second));
    } else {
      read.push_back({signal, line, placeOf(firmware, fmt::format("lines.{}", name))});
    }
  }
  return read;
}

std::string faultsOf(const std::vector<PinLine>& lines, const std::string& place, const SignalMap& machine,
                     bool gantry) {
  std::string faults;
  for (const PinLine& line : lines) {
    if (!machine.pin(line.signal)) addLine(faults, line.place + ": the machine has no such pin");
  }
  std::vector<Signal> needed{Signal::kLaserGate, Signal::kLaserPwm};
  if (gantry) {
    needed.insert(needed.end(),
                  {Signal::kGantryXPul, Signal::kGantryXDir, Signal::kGantryYPul, Signal::kGantryYDir});
  } else {
    needed.insert(needed.end(),
                  {Signal::kGalvoXPul, Signal::kGalvoXDir, Signal::kGalvoYPul, Signal::kGalvoYDir});
  }
  for (const Signal signal : needed) {
    if (!machine.pin(signal)) continue;
    if (std::ranges::find(lines, signal, &PinLine::signal) == lines.end())
      addLine(faults, fmt::format("{}: firmware.lines has no line for {}, which the machine has", place,
                                  signalName(signal)));
  }
  return faults;
}

GpioCaptureOptions captureOptions(const GpioChoice& choice, const GpioChipList& chips) {
  GpioCaptureOptions options;
  options.stamp_err_s = choice.stamp_err_s;
  options.quiet_s = choice.quiet_s;
  const auto at = [](const std::string& place, const auto& find) {
    try {
      return find();
    } catch (const GpioError& e) {
      throw GpioError(place + ": " + e.what());
    }
  };
  const GpioChipInfo* const chip = at(choice.place, [&] { return &findChip(chips, choice.chip); });
  options.chip = chip->path;
  std::string faults;
  std::map<std::uint32_t, Signal> users;
  for (const PinLine& line : choice.lines) {
    try {
      const std::uint32_t offset = at(line.place, [&] { return findLine(*chip, line.line).offset; });
      if (const auto [user, is_new] = users.emplace(offset, line.signal); !is_new)
        addLine(faults,
                fmt::format("{}: is line {}, and so is {}", line.place, offset, signalName(user->second)));
      options.wires.push_back({line.signal, offset});
    } catch (const GpioError& e) {
      addLine(faults, e.what());
    }
  }
  if (!faults.empty()) throw GpioError(faults);
  return options;
}

}  // namespace kerfbench::hil
