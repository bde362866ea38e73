// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "hil/doctor/doctor.h"
#include "hil/doctor/doctor_cameras.h"

namespace kerfbench::doctor {
namespace {

using Json = nlohmann::ordered_json;

const char* nameOf(DoctorFinding::Grade grade) {
  switch (grade) {
    case DoctorFinding::Grade::kGood:
      return "good";
    case DoctorFinding::Grade::kNote:
      return "note";
    case DoctorFinding::Grade::kTrouble:
      return "trouble";
    case DoctorFinding::Grade::kMissing:
      break;
  }
  return "missing";
}

std::string lineText(const source::GpioLineInfo& line) {
  std::string text = fmt::format("  {:3}  {:<20} {}{}", line.offset, line.name.empty() ? "-" : line.name,
                                 line.output ? "output" : "input", line.active_low ? ", active low" : "");
  if (line.used) text += line.consumer.empty() ? ", taken" : ", taken by '" + line.consumer + "'";
  return text + "\n";
}

std::string analysersText(const source::AnalyserList& list) {
  std::string text =
      fmt::format("{}, drivers for logic analysers: {}\n", list.library, fmt::join(list.drivers, " "));
  for (const source::AnalyserDevice& device : list.devices)
    text += fmt::format("{}\n  channels {}; {}\n", analyserName(device), fmt::join(device.channels, " "),
                        device.samplerates.empty() ? "does not tell its rates" : device.samplerates);
  return text + "recordings that are read: VCD (pins.vcd), session files of sigrok (.sr)\n";
}

Json analysersJson(const source::AnalyserList& list) {
  Json devices = Json::array();
  for (const source::AnalyserDevice& device : list.devices) {
    devices.push_back({{"driver", device.driver},
                       {"name", device.name},
                       {"serial", device.serial},
                       {"conn", device.conn},
                       {"channels", device.channels},
                       {"samplerates", device.samplerates}});
  }
  return {{"library", list.library}, {"drivers", list.drivers}, {"devices", std::move(devices)}};
}

Json chipJson(const source::GpioChipInfo& chip) {
  Json lines = Json::array();
  for (const source::GpioLineInfo& line : chip.lines) {
    lines.push_back({{"offset", line.offset},
                     {"name", line.name},
                     {"consumer", line.consumer},
                     {"used", line.used},
                     {"direction", line.output ? "output" : "input"},
                     {"active_low", line.active_low}});
  }
  return {
      {"path", chip.path.string()}, {"name", chip.name}, {"label", chip.label}, {"lines", std::move(lines)}};
}

}  // namespace

std::string findingsText(const std::vector<DoctorFinding>& findings) {
  std::string text;
  for (const DoctorFinding& finding : findings) {
    std::string indented;
    for (const char c : finding.text) indented += c == '\n' ? std::string("\n         ") : std::string(1, c);
    text += fmt::format("{:<7}  {}\n", nameOf(finding.grade), indented);
  }
  return text;
}

std::string doctorText(const ComputerState& state, const std::vector<DoctorFinding>& findings) {
  std::string text = state.kernel + "\n";
  for (const source::GpioChipInfo& chip : state.gpio.chips) {
    text += fmt::format("{} ({}), {} lines\n", chip.path.string(), chip.label, chip.lines.size());
    for (const source::GpioLineInfo& line : chip.lines) text += lineText(line);
  }
  for (const camera::CameraListing& camera : state.cameras) text += camera::describe(camera);
  if (!state.analysers.library.empty()) text += analysersText(state.analysers);
  text +=
      fmt::format("CLOCK_MONOTONIC: {} ns, by {}\n", state.clock_resolution_ns,
                  state.clock_source.empty() ? "a clock that the kernel does not name" : state.clock_source);
  return text + findingsText(findings);
}

namespace {

Json listOf(const std::vector<DoctorFinding>& findings) {
  Json list = Json::array();
  for (const DoctorFinding& finding : findings)
    list.push_back({{"grade", nameOf(finding.grade)}, {"text", finding.text}});
  return list;
}

std::string textOf(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace

std::string doctorJson(const ComputerState& state, const std::vector<DoctorFinding>& findings,
                       const std::string& scenario) {
  Json json;
  json["kernel"] = state.kernel;
  if (!scenario.empty()) json["scenario"] = scenario;
  Json chips = Json::array();
  for (const source::GpioChipInfo& chip : state.gpio.chips) chips.push_back(chipJson(chip));
  json["gpio"] = {{"chips", std::move(chips)}};
  json["cameras"] = camerasJson(state.cameras);
  json["analysers"] = analysersJson(state.analysers);
  json["clock"] = {{"source", state.clock_source}, {"resolution_ns", state.clock_resolution_ns}};
  json["real_time"] = {{"allowed", state.real_time_notes.empty()}};
  json["findings"] = listOf(findings);
  return textOf(json);
}

std::string findingsJson(const std::vector<DoctorFinding>& findings) {
  return textOf(Json{{"findings", listOf(findings)}});
}

}  // namespace kerfbench::doctor
