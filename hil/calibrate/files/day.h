// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace kerfbench::calibrate {

/// Days since 1970-01-01 of an ISO 8601 day, "2026-11-21"; nullopt for anything else. No clock is read.
std::optional<int> dayNumber(const std::string& iso_day);
/// The ISO 8601 day that many days after 1970-01-01; years 0 … 9999.
std::string isoDay(int days);

}  // namespace kerfbench::calibrate
