// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <Eigen/Core>

#include "hil/report/run_report.h"

namespace kerfbench::trace {

/// Begin of what the message holds, and the message.
using TakeMessage = std::function<void(double time_s, const std::string& json)>;

/// Messages of /spot: what the spot camera measured, with the line that it was on. `pixel`: where the camera
/// sees a place of W; empty: not known.
void spotMessages(const report::RunReport& report,
                  const std::function<Eigen::Vector2d(const Eigen::Vector2d& p_W_mm)>& pixel,
                  const TakeMessage& take);
/// Messages of /checks.
void checkMessages(const report::RunReport& report, const TakeMessage& take);

}  // namespace kerfbench::trace
