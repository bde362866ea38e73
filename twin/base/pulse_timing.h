// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kerfbench {

/// Requirements of a PUL/DIR drive on its pulses, as its data sheet gives them. LinuxCNC's stepper-timing
/// table uses the same four times.
struct DriverProfile {
  std::string name;
  bool active_edge_rising{true};  ///< The edge of PUL that steps.
  double setup_s{};               ///< Time that DIR is stable before the active edge; >= 0.
  double hold_s{};                ///< Time that DIR is stable after the active edge; >= 0.
  double width_s{};               ///< Shortest time of PUL at the active level; >= 0.
  double space_s{};               ///< Shortest time of PUL at the idle level; >= 0.
  bool dir_low{};                 ///< DIR is low for a step in the axis's positive direction, else high.

  /// Sense of a step that is latched while DIR has this level: +1 or -1.
  [[nodiscard]] constexpr int senseOf(bool dir) const { return dir != dir_low ? 1 : -1; }
};

/// Observed timing of one PUL/DIR pair over a run. Times in s; infinity while nothing was observed.
struct PulseTiming {
  std::string axis;  ///< "galvo_x", …
  DriverProfile profile;
  std::uint64_t pulses{};
  std::uint64_t setup_violations{};
  std::uint64_t hold_violations{};
  std::uint64_t width_violations{};
  std::uint64_t space_violations{};
  double min_setup_s{};
  double min_hold_s{};
  double min_width_s{};
  double min_space_s{};
  double first_violation_s{-1.0};  ///< Time of the first violation of any kind; < 0: none.
  /// Number of active edges whose DIR set-up fell in bin i: [i, i+1) * setup_bin_s, the last bin open.
  std::vector<std::uint64_t> setup_histogram;
  double setup_bin_s{0.5e-6};
};

}  // namespace kerfbench
