// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kerfbench::hil {

/// What all commands that judge have in common. See DESIGN: the program.
struct CommonOptions {
  std::filesystem::path results_dir{"results"};
  std::optional<std::uint64_t> seed;   ///< Instead of the scenario's.
  std::optional<double> time_limit_s;  ///< Virtual; instead of the scenario's.
  int jobs{1};
  bool quiet{};
  bool timing{};
  std::filesystem::path bin_dir;  ///< Where kerfbench and its children are.
  std::string command_line;       ///< As typed, for the report.
};

inline constexpr int kExitBroken = 2;  ///< The bench itself broke.
inline constexpr int kExitUsage = 64;  ///< Wrong command line.
inline constexpr int kExitInput = 65;  ///< Bad input file.

/// Runs every scenario; returns the worst exit code (INVALID before FAIL before NOT PROVEN before PASS).
int runCommand(const std::vector<std::filesystem::path>& scenarios, const CommonOptions& options);
/// Judges a recording of pins as if it were live.
int replayCommand(const std::filesystem::path& recording, const std::filesystem::path& scenario,
                  const CommonOptions& options);
/// Checks a scenario, a machine or a dieline. Returns 0, or kExitInput when something is wrong with a file.
int lintCommand(const std::vector<std::filesystem::path>& files, const CommonOptions& options);

}  // namespace kerfbench::hil
