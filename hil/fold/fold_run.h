// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kerfbench::fold {

struct FoldOptions {
  std::vector<std::filesystem::path> scenarios;
  std::filesystem::path out{
      "results/fold"};       ///< Results; of several scenarios each has a folder of its name.
  std::string command_line;  ///< As typed.
  int jobs{1};               ///< Threads; the results are the same at any number.
  bool quiet{};              ///< Only the verdict.
};

/// Reads a scenario, cuts its blank on the model, photographs and judges it, and writes the results folder:
/// program.gcode, junit.xml, report.html and, last, fold.json; each file is there whole or not at all.
/// Returns the exit code of the verdict. @throws base::ConfigError, base::InputError, std::system_error.
int runFold(const std::filesystem::path& scenario, const std::filesystem::path& out,
            const FoldOptions& options);

}  // namespace kerfbench::fold
