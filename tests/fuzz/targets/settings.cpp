// SPDX-License-Identifier: Apache-2.0
#include "hil/base/yaml_reader.h"
#include "hil/machine_file/machine_file.h"
#include "hil/scenario/scenario.h"
#include "tests/fuzz/targets.h"

namespace kerfbench::fuzz {

/// What it names need not be there: each that is missing is a fault among the others. True where the text was
/// a mapping.
bool scenarioFile(Bytes bytes) {
  return takes<base::ConfigError>(
      [&] { (void)scenario::draftScenario(asFile("scenario.yaml", bytes), std::string(textIn(bytes)), {}); });
}

bool machineFile(Bytes bytes) {
  return takes<base::ConfigError>(
      [&] { (void)machine_file::readMachineFile(asFile("machine.yaml", bytes)); });
}

}  // namespace kerfbench::fuzz
