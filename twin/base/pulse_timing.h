// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kerfbench {

/// What a PUL/DIR drive asks of its pulses, as its data sheet gives it (LinuxCNC's
/// stepper-timing table uses the same four times).
struct DriverProfile {
  std::string name;
  bool active_edge_rising{true};  ///< The edge of PUL that steps.
  double setup_s{};               ///< DIR stable before the active edge; >= 0.
  double hold_s{};                ///< DIR stable after the active edge; >= 0.
  double width_s{};               ///< PUL at the active level at least this long; >= 0.
  double space_s{};               ///< PUL at the idle level at least this long; >= 0.
};

/// What was seen of one PUL/DIR pair over a run. Times in s; infinity while nothing was seen.
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
