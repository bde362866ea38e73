// SPDX-License-Identifier: Apache-2.0
#include "hil/calibrate/files/day.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

namespace kerfbench::calibrate {

std::optional<int> dayNumber(const std::string& iso_day) {
  if (iso_day.size() != 10 || iso_day[4] != '-' || iso_day[7] != '-') return std::nullopt;
  const std::string digits = iso_day.substr(0, 4) + iso_day.substr(5, 2) + iso_day.substr(8, 2);
  if (!std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; })) return std::nullopt;
  const std::chrono::year_month_day day{
      std::chrono::year(std::stoi(digits.substr(0, 4))),
      std::chrono::month(static_cast<unsigned>(std::stoi(digits.substr(4, 2)))),
      std::chrono::day(static_cast<unsigned>(std::stoi(digits.substr(6, 2))))};
  if (!day.ok()) return std::nullopt;
  return static_cast<int>(std::chrono::sys_days(day).time_since_epoch().count());
}

std::string isoDay(int days) {
  const std::chrono::year_month_day day{std::chrono::sys_days(std::chrono::days(days))};
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(day.year()), static_cast<unsigned>(day.month()),
                     static_cast<unsigned>(day.day()));
}

}  // namespace kerfbench::calibrate
