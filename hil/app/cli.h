// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace kerfbench::app {

/// What the program knows of itself.
struct CliProgram {
  std::filesystem::path bin_dir;  ///< Where kerfbench and its children are.
  std::string command_line;       ///< As typed.
  int jobs{1};                    ///< Unless told otherwise.
};

/// What is to be done for each command.
class CliActions {
 public:
  /// `command` must outlive this.
  void add(const CLI::App* command, std::function<int()> action) {
    actions_.emplace_back(command, std::move(action));
  }
  /// For a command whose options `action` takes.
  template <typename Options>
  void add(const CLI::App* command, std::shared_ptr<Options> options, int (*action)(const Options&)) {
    add(command, [options = std::move(options), action] { return action(*options); });
  }
  /// Does what was asked for on the command line. Returns its exit code; nullopt if nothing was.
  [[nodiscard]] std::optional<int> run() const {
    for (const auto& [command, action] : actions_) {
      if (command->parsed()) return action();
    }
    return std::nullopt;
  }

 private:
  std::vector<std::pair<const CLI::App*, std::function<int()>>> actions_;
};

/// Each adds commands with their options and help.
void addShow(CLI::App& app, const CliProgram& program, CliActions& actions);
void addGauge(CLI::App& app, const CliProgram& program, CliActions& actions);
void addRecordFrames(CLI::App& app, const CliProgram& program, CliActions& actions);
void addCapture(CLI::App& app, const CliProgram& program, CliActions& actions);
void addDoctor(CLI::App& app, const CliProgram& program, CliActions& actions);
/// With all that is below it.
void addCalibrate(CLI::App& app, const CliProgram& program, CliActions& actions);
/// Below `calibrate`, beside `calibrate head`: check, reversal, table.
void addHeadTools(CLI::App& calibrate, const CliProgram& program, CliActions& actions);

}  // namespace kerfbench::app
