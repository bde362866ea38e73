// SPDX-License-Identifier: Apache-2.0
#include "hil/doctor/doctor.h"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <sstream>
#include <system_error>
#include <utility>

#include "hil/base/file_content.h"
#include "hil/base/installation.h"
#include "hil/doctor/doctor_cameras.h"
#include "hil/scenario/camera_files.h"
#include "hil/scenario/gpio_choice.h"
#include "hil/source/child_connection.h"
#include "hil/source/confinement.h"
#include "hil/source/gpio/line_request.h"
#include "hil/source/gpio/real_time.h"

namespace kerfbench::doctor {
namespace {

namespace fs = std::filesystem;
using Grade = DoctorFinding::Grade;

void lookAtLines(const source::GpioChipInfo& chip, const std::vector<source::GpioWire>& wires,
                 const ComputerState& state, std::vector<DoctorFinding>& findings) {
  for (const source::GpioWire& wire : wires) {
    const source::GpioLineInfo& line = source::findLine(chip, std::to_string(wire.offset));
    const std::string which =
        fmt::format("{}: line {} for {}", chip.path.string(), wire.offset, signalName(wire.signal));
    if (line.used) {
      findings.push_back({Grade::kMissing, fmt::format("{} is taken by '{}'", which, line.consumer)});
    } else {
      findings.push_back({Grade::kGood, which + " is free"});
    }
  }
  for (const std::string& trouble : state.gpio_troubles) {
    if (trouble.starts_with(chip.path.string() + ":")) findings.push_back({Grade::kMissing, trouble});
  }
}

void lookAtUart(const std::string& path, std::vector<DoctorFinding>& findings) {
  if (path.empty()) return;
  if (::access(path.c_str(), R_OK | W_OK) == 0) {
    findings.push_back({Grade::kGood, path + " is there, for the controller's UART"});
    return;
  }
  findings.push_back({Grade::kMissing, fmt::format("{}, for the controller's UART: {}", path,
                                                   std::generic_category().message(errno))});
}

void lookAtPins(const scenario::GpioChoice& choice, const ComputerState& state,
                std::vector<DoctorFinding>& findings) {
  try {
    const source::GpioLiveOptions options = scenario::liveOptions(choice, state.gpio);
    lookAtLines(source::findChip(state.gpio, options.in.chip.string()), options.in.wires, state, findings);
    if (!options.out.empty()) {
      const source::GpioChipInfo& chip = source::findChip(state.gpio, options.out_chip.string());
      const bool same = options.out_chip == options.in.chip;
      lookAtLines(chip, options.out, same ? ComputerState{} : state, findings);
    }
  } catch (const source::GpioError& e) {
    findings.push_back({Grade::kMissing, e.what()});
  }
  lookAtUart(choice.uart, findings);
}

void lookAtRelease(const scenario::FirmwareChoice& firmware, const fs::path& bin_dir,
                   std::vector<DoctorFinding>& findings) {
  const fs::path program = firmware.childIn(bin_dir);
  if (source::isConnection(program)) {
    findings.push_back(
        {Grade::kNote, program.string() + " is asked when a run begins; doctor --child tries it"});
    return;
  }
  if (const std::string& trouble = source::troubleOfBubblewrap();
      firmware.emulator() == nullptr && !trouble.empty())
    findings.push_back(
        {Grade::kNote,
         program.string() + " will see files and network like any program of yours, because " + trouble});
  const bool there = fs::is_regular_file(program);
  findings.push_back(
      {there ? Grade::kGood : Grade::kMissing,
       fmt::format("{} {}", program.string(),
                   there                        ? "runs the release"
                   : base::isInstalled(bin_dir) ? "is not there: install the package kerfbench-emulators"
                                                : "is not there: build it")});
}

}  // namespace

std::string kernelName() {
  utsname name{};
  return ::uname(&name) == 0 ? fmt::format("{} {}", name.sysname, name.release) : "";
}

std::string clockSource() {
  std::istringstream file(
      base::fileContent("/sys/devices/system/clocksource/clocksource0/current_clocksource").value_or(""));
  std::string name;
  file >> name;
  return name;
}

ComputerState lookAtComputer(const std::shared_ptr<source::GpioSystem>& system, camera::VideoCalls& video) {
  ComputerState state;
  state.cameras = camera::listCameras(video);
  state.kernel = kernelName();
  state.gpio = source::listChips();
  for (const source::GpioChipInfo& chip : state.gpio.chips) {
    if (std::string trouble = source::edgeTrouble(*system, chip.path); !trouble.empty())
      state.gpio_troubles.push_back(std::move(trouble));
  }
  state.clock_source = clockSource();
  timespec resolution{};
  ::clock_getres(CLOCK_MONOTONIC, &resolution);
  state.clock_resolution_ns = static_cast<std::uint64_t>(resolution.tv_sec) * 1'000'000'000U +
                              static_cast<std::uint64_t>(resolution.tv_nsec);
  state.real_time_notes = source::RealTime(system).notes();
  return state;
}

std::vector<DoctorFinding> findingsOf(const ComputerState& state) {
  std::vector<DoctorFinding> findings;
  if (state.gpio.chips.empty() && state.gpio.faults.empty())
    findings.push_back({Grade::kNote, "no gpiochip: scenarios on real pins (source: gpio) cannot run here"});
  for (const std::string& fault : state.gpio.faults) findings.push_back({Grade::kTrouble, fault});
  for (const std::string& trouble : state.gpio_troubles) findings.push_back({Grade::kTrouble, trouble});
  addAnalyserFindings(state, findings);
  if (state.clock_resolution_ns > 1) {
    findings.push_back(
        {Grade::kTrouble,
         fmt::format("CLOCK_MONOTONIC has a resolution of {} ns: edges are stamped as coarsely; it needs "
                     "a kernel with high-resolution timers",
                     state.clock_resolution_ns)});
  }
  if (state.clock_source == "jiffies" || state.clock_source == "refined-jiffies") {
    findings.push_back(
        {Grade::kTrouble, fmt::format("the kernel's clock is '{}', which steps by milliseconds: no edge "
                                      "can be placed in time",
                                      state.clock_source)});
  } else if (state.clock_source == "hpet" || state.clock_source == "acpi_pm") {
    findings.push_back(
        {Grade::kNote, fmt::format("the kernel's clock is '{}', slow to read: the kernel has found the "
                                   "processor's own clock (tsc) unstable",
                                   state.clock_source)});
  }
  addCameraFindings(state.cameras, findings);
  for (const std::string& note : state.real_time_notes) findings.push_back({Grade::kNote, note});
  if (findings.empty()) findings.push_back({Grade::kGood, "nothing is wrong"});
  return findings;
}

std::vector<DoctorFinding> needsOf(const scenario::Case& test_case, const ComputerState& state,
                                   const fs::path& bin_dir) {
  std::vector<DoctorFinding> findings;
  const scenario::FirmwareChoice& firmware = test_case.scenario.firmware;
  if (firmware.source == scenario::FirmwareChoice::Source::kGpio) {
    lookAtPins(firmware.gpio, state, findings);
  } else if (firmware.source == scenario::FirmwareChoice::Source::kAnalyser) {
    addAnalyserNeeds(firmware.analyser, state, findings);
  } else {
    lookAtRelease(firmware, bin_dir, findings);
  }
  addCameraNeeds(test_case, state.cameras, findings);
  const std::vector<std::string> cameras = scenario::readCalibrations(test_case).problems;
  for (const std::string& problem : cameras) findings.push_back({Grade::kMissing, problem});
  if (cameras.empty()) findings.push_back({Grade::kGood, "the cameras are calibrated"});
  return findings;
}

}  // namespace kerfbench::doctor
