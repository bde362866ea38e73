// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "hil/app/table_command.h"

namespace kerfbench::hil {

/// The sub-commands of `calibrate` that work beside `calibrate head`.
class HeadToolsCli {
 public:
  explicit HeadToolsCli(CLI::App& calibrate);
  /// Runs the one that was asked for; nullopt if none was.
  [[nodiscard]] std::optional<int> run() const;

 private:
  void addTable(CLI::App& calibrate);

  TableCommandOptions table_;
  CLI::App* table_command_{};
};

}  // namespace kerfbench::hil
