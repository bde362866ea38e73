// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "hil/base/yaml_reader.h"

namespace kerfbench::base {

/// Faults as people read them, a line each: "file:line: key: what is wrong"; of many the first 200, and how
/// many more there are.
std::string faultsText(const std::vector<YamlReader::Fault>& faults);

}  // namespace kerfbench::base
