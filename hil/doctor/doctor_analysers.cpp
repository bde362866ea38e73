// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "hil/doctor/doctor.h"

namespace kerfbench::doctor {
namespace {

using Grade = DoctorFinding::Grade;

/// Whether the device is libsigrok's demo, which has patterns for tests instead of pins.
bool isDemo(const source::AnalyserDevice& device) { return device.driver == "demo"; }

void lookAtChannels(const scenario::AnalyserChoice& choice, const source::AnalyserDevice& device,
                    std::vector<DoctorFinding>& findings) {
  const std::string which = analyserName(device);
  bool all = true;
  for (const scenario::PinLine& line : choice.lines) {
    if (std::ranges::find(device.channels, line.line) != device.channels.end()) continue;
    findings.push_back({Grade::kMissing, fmt::format("{}: {} has no channel '{}'; it has {}", line.place,
                                                     which, line.line, fmt::join(device.channels, " "))});
    all = false;
  }
  if (all) findings.push_back({Grade::kGood, which + " has the channels"});
}

}  // namespace

std::string analyserName(const source::AnalyserDevice& device) {
  std::string words = device.driver + ": " + device.name;
  if (!device.serial.empty()) words += ", serial " + device.serial;
  if (!device.conn.empty()) words += ", at " + device.conn;
  return words;
}

void lookAtAnalysers(source::AnalyserSystem& system, ComputerState& state) {
  try {
    state.analysers = system.list();
  } catch (const source::AnalyserError& e) {
    state.analyser_trouble = std::string("logic analysers (kerfbench-sigrok): ") + e.what();
  }
}

void addAnalyserFindings(const ComputerState& state, std::vector<DoctorFinding>& findings) {
  if (!state.analyser_trouble.empty()) findings.push_back({Grade::kTrouble, state.analyser_trouble});
  for (const std::string& fault : state.analysers.faults) findings.push_back({Grade::kTrouble, fault});
  if (state.analyser_trouble.empty() && std::ranges::all_of(state.analysers.devices, isDemo)) {
    findings.push_back({Grade::kNote,
                        "no logic analyser is found without being told where (firmware.conn): it is not "
                        "plugged in, or this user may not use it"});
  }
}

void addAnalyserNeeds(const scenario::AnalyserChoice& choice, const ComputerState& state,
                      std::vector<DoctorFinding>& findings) {
  const auto missing = [&](const std::string& words) {
    findings.push_back({Grade::kMissing, choice.place + ": " + words});
  };
  if (!state.analyser_trouble.empty()) return missing(state.analyser_trouble);
  if (std::ranges::find(state.analysers.drivers, choice.driver) == state.analysers.drivers.end())
    return missing(fmt::format("{} has no driver '{}' for logic analysers; it has {}",
                               state.analysers.library, choice.driver,
                               fmt::join(state.analysers.drivers, " ")));
  std::vector<source::AnalyserDevice> fit = state.analysers.devices;
  std::erase_if(fit, [&](const source::AnalyserDevice& device) {
    return device.driver != choice.driver || (!choice.serial.empty() && device.serial != choice.serial) ||
           (!choice.conn.empty() && device.conn != choice.conn);
  });
  // A serial port, or vendor and product, are only looked at when they are named.
  if (fit.empty() && !choice.conn.empty()) {
    findings.push_back(
        {Grade::kNote, fmt::format("{}: whether there is an analyser at {} shows when it is used",
                                   choice.place, choice.conn)});
  } else if (fit.empty()) {
    missing(fmt::format("the driver {} finds no analyser{}: is it plugged in, and may this user use it?",
                        choice.driver, choice.serial.empty() ? "" : " with the serial " + choice.serial));
  } else if (fit.size() > 1) {
    missing(fmt::format("the driver {} finds {} analysers: name one by conn or serial", choice.driver,
                        fit.size()));
  } else {
    lookAtChannels(choice, fit.front(), findings);
  }
}

}  // namespace kerfbench::doctor
