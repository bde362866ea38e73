// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "hil/command_line/command_tree.h"

namespace kerfbench::command_line {

/// What every program of the bench does alike: it reads its command line, tells help and faults, prints
/// completions and man pages, and chooses whether it writes in colour.
class Dialogue {
 public:
  /// Adds the commands completion and man and the option --color to `app`, which has all its other commands
  /// and must outlive this. `version`: for the foot of the pages.
  Dialogue(CLI::App& app, std::string version);

  /// The command's code, options included, is in another program, by which `become` replaces this process.
  void handOver(const std::string& command, std::function<void()> become);
  /// The program has some commands of another program of the same name, whose own page is not its matter.
  void onlyCommands() { only_commands_ = true; }

  /// Reads the command line. Returns an exit code if all is done: help, version, a completion or a page was
  /// asked for, or something is wrong, which is told on standard error.
  std::optional<int> read(int argc, char** argv);

 private:
  [[nodiscard]] CommandTree tree() const;
  int complete(const std::vector<std::string>& words) const;
  int tellFault(const CLI::ParseError& fault, const std::vector<std::string>& words) const;
  int tellPages() const;

  CLI::App& app_;
  std::string version_;
  bool only_commands_{false};
  std::map<std::string, std::function<void()>> elsewhere_;
  CLI::App* completion_{};
  CLI::App* man_{};
  std::string shell_;
  std::vector<std::string> page_;
  std::filesystem::path folder_;
  std::string colour_{"auto"};
};

}  // namespace kerfbench::command_line
