// SPDX-License-Identifier: Apache-2.0
#include "hil/machine_file/machine_check.h"

#include <algorithm>

#include "twin/cutter/machine_faults.h"

namespace kerfbench::machine_file {
namespace {

void refuse(const MachineFile& file, const std::vector<std::string>& faults) {
  std::string message;
  for (const std::string& fault : faults) {
    // A fault begins with what is wrong: "galvo_x.stiffness must be …", "belt: …".
    const std::string field = fault.substr(0, fault.find_first_of(" :"));
    message += (message.empty() ? "" : "\n") + file.placeOf(field) + ": " + fault;
  }
  if (!message.empty()) throw base::ConfigError(message);
}

}  // namespace

void refuseUnfit(const MachineFile& file, const twin::WebDescription& web) {
  refuse(file, twin::faultsOf(file.machine, web));
}

void refuseUnfit(const MachineFile& file) {
  twin::WebDescription web;
  web.print.pitch_mm = 100.0;
  std::vector<std::string> faults = twin::faultsOf(file.machine, web);
  web.fed_by_controller = true;
  if (file.machine.belt.feed.step > 0) {
    for (const std::string& fault : twin::faultsOf(file.machine, web)) {
      if (std::ranges::find(faults, fault) == faults.end()) faults.push_back(fault);
    }
  }
  refuse(file, faults);
}

}  // namespace kerfbench::machine_file
