// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "hil/machine_file/machine_sections.h"

namespace kerfbench::machine_file {
namespace {

using twin::MachineDescription;

/// "PA0": letter of the port and bit; "P1.0", as an 8051 has it: number of the port and bit.
std::optional<PinId> pinFromName(const std::string& name) {
  static const std::regex kPin("P(?:([A-Z])|([0-9])\\.)([0-9]|1[0-5])");
  std::smatch match;
  if (!std::regex_match(name, match, kPin)) return std::nullopt;
  const int port = match[1].matched ? *match[1].first - 'A' : *match[2].first - '0';
  return PinId{static_cast<std::uint16_t>(port), static_cast<std::uint16_t>(std::stoi(match[3]))};
}

// What no machine of this kind can do without; a pin that is forgotten would look like a firmware that is
// dead.
std::vector<Signal> neededSignals(MachineDescription::Kind kind) {
  std::vector<Signal> needed{Signal::kLaserGate, Signal::kEncoderA, Signal::kEncoderB, Signal::kPrintMark};
  if (kind == MachineDescription::Kind::kGantry) {
    needed.insert(needed.end(),
                  {Signal::kGantryXPul, Signal::kGantryXDir, Signal::kGantryYPul, Signal::kGantryYDir});
  } else {
    needed.insert(needed.end(),
                  {Signal::kGalvoXPul, Signal::kGalvoXDir, Signal::kGalvoYPul, Signal::kGalvoYDir});
  }
  return needed;
}

}  // namespace

SignalMap readPins(base::YamlReader pins, MachineDescription::Kind kind) {
  SignalMap map;
  std::map<PinId, Signal> users;
  const std::vector<Signal> needed = neededSignals(kind);
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    const auto signal = static_cast<Signal>(i);
    const std::string_view name = signalName(signal);
    if (!pins.has(name)) {
      if (std::ranges::find(needed, signal) != needed.end()) pins.fault(name, "has no pin");
      continue;
    }
    const std::string pin_name = pins.text(name);
    const auto pin = pinFromName(pin_name);
    if (!pin) {
      pins.fault(name, fmt::format("'{}' is no pin like PA0 or P1.0", pin_name));
      continue;
    }
    const Signal user = users.emplace(*pin, signal).first->second;
    if (user != signal && !(isEnable(user) && isEnable(signal))) {
      pins.fault(name, fmt::format("{} is given to {} and to {}{}", pin_name, signalName(user), name,
                                   signal == Signal::kLaserPwm && user == Signal::kLaserGate
                                       ? ": a pin that is both is the gate, with `laser_pwm: ~`"
                                       : ""));
      continue;
    }
    map.assign(signal, *pin);
  }
  return map;
}

}  // namespace kerfbench::machine_file
