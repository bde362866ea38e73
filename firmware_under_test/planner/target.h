// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace kerfbench::planner {

/// The controller that is planned for, as its release says (controller/release.h). The defaults are those of
/// the AVR release.
struct Target {
  double tick_s{25e-6};
  int ticks_per_period{32};
  int max_steps{31};  ///< Of an axis in a period.
  int longest_delay_ticks{255};
  std::uint32_t baud{250'000};
  // Of PUL and DIR, never less than:
  double setup_s{5e-6};     ///< DIR stable before the active edge.
  double hold_s{6.25e-6};   ///< DIR stable after it.
  double width_s{6.25e-6};  ///< PUL active.
  double space_s{5e-6};     ///< PUL idle.
  std::string name{"avr"};
  std::string version;

  /// An interpolation period.
  [[nodiscard]] double periodS() const { return tick_s * ticks_per_period; }
  /// Steps per period that the planner gives an axis: the rest is for rounding and for what the follow
  /// correction adds when the belt runs unevenly.
  [[nodiscard]] int stepBudget() const { return max_steps - (max_steps > 30 ? (max_steps + 7) / 12 : 1); }
  [[nodiscard]] double longestDelayS() const { return longest_delay_ticks * tick_s; }
};

/// From the block as it lies in images and in INFO, magic and all; nullopt if it is none that this planner
/// knows.
std::optional<Target> targetFrom(std::span<const std::uint8_t> block);
/// Of a release image: Intel hex (.hex, .ihx), or any file that holds the block as it is.
/// @throws PlanError if it cannot be read, or does not hold exactly one block.
Target targetOfImage(const std::filesystem::path& image);
/// What the program, planned for `wanted`, does not find in `found`; empty if it can run there.
std::string differenceOf(const Target& wanted, const Target& found);

}  // namespace kerfbench::planner
