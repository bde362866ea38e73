// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace kerfbench {

/// Requirements of a PUL/DIR drive on its pulses, as its data sheet gives them, and the levels that it
/// listens to. LinuxCNC's stepper-timing table uses the same four times of PUL and DIR.
struct DriverProfile {
  std::string name;
  bool active_edge_rising{true};  ///< The edge of PUL that steps.
  double setup_s{};               ///< Time that DIR is stable before the active edge; >= 0.
  double hold_s{};                ///< Time that DIR is stable after the active edge; >= 0.
  double width_s{};               ///< Shortest time of PUL at the active level; >= 0.
  double space_s{};               ///< Shortest time of PUL at the idle level; >= 0.
  bool dir_low{};                 ///< DIR is low for a step in the axis's positive direction, else high.
  bool enable_low{};        ///< The drive is enabled while its enable line is low, else while it is high.
  double enable_setup_s{};  ///< Time that it is enabled before the first change of DIR or PUL; >= 0.

  /// Sense of a step that is latched while DIR has this level: +1 or -1.
  [[nodiscard]] constexpr int senseOf(bool dir) const { return dir != dir_low ? 1 : -1; }
  /// Whether the drive is enabled while its enable line has this level. Before its first change the line is
  /// low.
  [[nodiscard]] constexpr bool enabledBy(bool level) const { return level != enable_low; }
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
  std::uint64_t enable_setup_violations{};
  std::uint64_t disabled_pulses{};  ///< Pulses while the drive was disabled; they are among `pulses`.
  double min_setup_s{};
  double min_hold_s{};
  double min_width_s{};
  double min_space_s{};
  /// From enable to DIR or PUL; infinity also where the drive has no enable line.
  double min_enable_setup_s{std::numeric_limits<double>::infinity()};
  bool has_enable{};               ///< The drive has an enable line.
  double first_violation_s{-1.0};  ///< Time of the first violation of any kind; < 0: none.
  /// Number of active edges whose DIR set-up fell in bin i: [i, i+1) * setup_bin_s, the last bin open.
  std::vector<std::uint64_t> setup_histogram;
  double setup_bin_s{0.5e-6};
};

}  // namespace kerfbench
