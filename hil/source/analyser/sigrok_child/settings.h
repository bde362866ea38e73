// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "hil/source/analyser/sigrok_child/library.h"

namespace kerfbench::sigrok_child {

/// Settings of a driver by sigrok's names, as "voltage_threshold" "1.2-1.2", of the device or of the one of
/// its channel groups that has them. @throws SigrokError for the first that it does not take.
void applySettings(Library& library, sr_dev_inst* device,
                   const std::vector<std::pair<std::string, std::string>>& settings);

}  // namespace kerfbench::sigrok_child
