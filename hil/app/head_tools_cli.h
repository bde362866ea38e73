// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "hil/app/head_check_command.h"
#include "hil/app/reversal_command.h"
#include "hil/app/table_command.h"

namespace kerfbench::hil {

/// The sub-commands of `calibrate` that work beside `calibrate head`.
class HeadToolsCli {
 public:
  /// What the program knows of itself.
  struct Program {
    std::filesystem::path bin_dir;
    std::string command_line;
    int jobs{1};
  };
  HeadToolsCli(CLI::App& calibrate, const Program& program);
  /// Runs the one that was asked for; nullopt if none was.
  [[nodiscard]] std::optional<int> run() const;

 private:
  void addTable(CLI::App& calibrate);
  void addCheck(CLI::App& calibrate);
  void addReversal(CLI::App& calibrate);

  TableCommandOptions table_;
  CLI::App* table_command_{};
  HeadCheckOptions check_;
  CLI::App* check_command_{};
  ReversalCommandOptions reversal_;
  CLI::App* reversal_command_{};
};

}  // namespace kerfbench::hil
