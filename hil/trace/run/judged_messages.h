// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "hil/report/run_report.h"

namespace kerfbench::trace {

/// Begin of what the message holds, and the message.
using TakeMessage = std::function<void(double time_s, const std::string& json)>;

/// Messages of /spot: what the spot camera measured, with the line that it was on.
void spotMessages(const report::RunReport& report, const TakeMessage& take);
/// Messages of /checks.
void checkMessages(const report::RunReport& report, const TakeMessage& take);

}  // namespace kerfbench::trace
