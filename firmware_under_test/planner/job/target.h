// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace kerfbench::planner {

inline constexpr double kMicrosecondsPerSecond = 1e6;

/// Controller that a job is planned for, as its release describes it (controller/release.h). The defaults are
/// those of the AVR release.
struct Target {
  double tick_s{25e-6};
  int ticks_per_period{32};
  int max_steps{31};  ///< Most steps of an axis in a period.
  int longest_delay_ticks{255};
  std::uint32_t baud{250'000};
  // Shortest times of PUL and DIR that the firmware produces:
  double setup_s{5e-6};     ///< DIR stable before the active edge.
  double hold_s{6.25e-6};   ///< DIR stable after it.
  double width_s{6.25e-6};  ///< PUL active.
  double space_s{5e-6};     ///< PUL idle.
  double late_s{16.25e-6};  ///< Longest lateness of a tick.
  std::string name{"avr"};
  std::string version;

  /// Length of an interpolation period.
  [[nodiscard]] double periodS() const { return tick_s * ticks_per_period; }
  /// Steps per period that the planner gives an axis, of the most that it can make: the rest is for rounding
  /// and for the follow correction when the belt runs unevenly.
  [[nodiscard]] static int stepBudget(int most_steps) {
    return most_steps - (most_steps > 30   ? (most_steps + 7) / 12
                         : most_steps > 12 ? 2
                         : most_steps > 1  ? 1
                                           : 0);
  }
  [[nodiscard]] double longestDelayS() const { return longest_delay_ticks * tick_s; }
};

/// Reads a block as it lies in images and in INFO, with its magic; nullopt if this planner does not know it.
std::optional<Target> targetFrom(std::span<const std::uint8_t> block);
/// Reads a release image as below; nullopt if it holds no block.
/// @throws PlanError if it cannot be read, or holds more than one.
std::optional<Target> findTarget(const std::filesystem::path& image);
/// Reads a release image: Intel hex (.hex, .ihx), or any file that holds the block as it is.
/// @throws PlanError if it cannot be read, or does not hold exactly one block.
Target targetOfImage(const std::filesystem::path& image);
/// Description for people: "0.1.0+5992ccb820b1, avr: ticks of 25 us, 32 a period, …"
std::string describe(const Target& target);
/// Describes what the program, planned for `wanted`, misses in `found`; empty if it can run there.
std::string differenceOf(const Target& wanted, const Target& found);

}  // namespace kerfbench::planner
