// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace kerfbench::inspect {

/// The names of all checks of a run, in the order of docs/reference/checks.md.
inline constexpr std::array<std::string_view, 30> kCheckNames{
    "path",         "edge",          "joints",         "coverage",   "bridges",       "depth",
    "even_depth",   "ordered_depth", "perforation",    "kerf_width", "ordered_width", "laser_timing",
    "stray",        "stillness_x",   "stillness_peak", "belt",       "spot_seen",     "spot_path",
    "repeat",       "dwell",         "gate_lag",       "laser_gate", "line_energy",   "interlock",
    "pulse_timing", "account",       "finish",         "safe_state", "safe_stop",     "safe_report"};

}  // namespace kerfbench::inspect
