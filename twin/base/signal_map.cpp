// SPDX-License-Identifier: Apache-2.0
#include "twin/base/signal_map.h"

#include <algorithm>
#include <cstddef>

namespace kerfbench {
namespace {
constexpr std::array<std::string_view, kSignalCount> kNames{
    "galvo_x_pul",     "galvo_x_dir",  "galvo_y_pul",    "galvo_y_dir",    "gantry_x_pul",
    "gantry_x_dir",    "gantry_y_pul", "gantry_y_dir",   "feed_pul",       "feed_dir",
    "laser_gate",      "laser_pwm",    "galvo_x_enable", "galvo_y_enable", "gantry_x_enable",
    "gantry_y_enable", "feed_enable",  "encoder_a",      "encoder_b",      "print_mark",
    "limit_x",         "limit_y",      "interlock",      "power_monitor",  "start"};
}  // namespace

std::string_view signalName(Signal signal) { return kNames.at(static_cast<std::size_t>(signal)); }

bool SignalMap::hasOwnWire(Signal signal) const {
  const auto own = pins_.begin() + static_cast<std::ptrdiff_t>(signal);
  return own->has_value() && std::find(pins_.begin(), own, *own) == own;
}

std::optional<Signal> signalFromName(std::string_view name) {
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    if (kNames.at(i) == name) return static_cast<Signal>(i);
  }
  return std::nullopt;
}

}  // namespace kerfbench
