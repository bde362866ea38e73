// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace kerfbench::fuzz {

/// A sound input for targets whose readers take one that is short: name of the target, bytes.
std::vector<std::pair<std::string, std::string>> soundInputs();

}  // namespace kerfbench::fuzz
