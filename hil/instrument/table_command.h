// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "hil/base/exit_codes.h"

namespace kerfbench::instrument {

/// See calibrateTableCommand().
struct TableCommandOptions {
  std::filesystem::path file;
  std::string format;                   ///< Format of the file; empty: by its content.
  std::string cor{"default"};           ///< Whose convention a .cor follows: default, glase, meerk40t, added.
  std::optional<double> units_per_mm;   ///< Scale of a .cor; otherwise the file's, or what fits the table.
  std::optional<double> mm_per_index;   ///< Distance of nine points; otherwise the file's.
  std::filesystem::path check;          ///< Nine points without correction; empty: no check.
  double sigma_mm{0.02};                ///< Standard deviation of a coordinate of the check.
  std::filesystem::path out;            ///< Empty: nothing is written.
  std::string to{"csv"};                ///< Format of `out`.
  int columns{}, rows{};                ///< Columns and rows of `out`; 0: as the table has them.
  bool wide{};                          ///< C header: int32 in place of int16.
  std::string prefix{"KB_CORRECTION"};  ///< C header.
  bool quiet{};
};

/// Whose conventions of .cor files are known by name.
inline constexpr const char* kCorConventions[] = {"default", "glase", "meerk40t", "added"};

/// Tells what a correction table is; holds it against a check; writes it in another format, righted if the
/// check says that it is to be. Returns 0; with a check 1 for a table that must not be used as it is (and is
/// not righted by `out`) and 4 if the check cannot tell, both with nothing written; base::kExitInput.
int calibrateTableCommand(const TableCommandOptions& options);

}  // namespace kerfbench::instrument
