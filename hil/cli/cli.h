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

#include "hil/cli/end_on_signal.h"

namespace kerfbench::cli {

/// What a program knows of itself.
struct CliProgram {
  std::filesystem::path bin_dir;  ///< See binDir().
  char** argv{};                  ///< As main() got it.
  std::string command_line;       ///< As typed.
  int jobs{1};                    ///< Unless told otherwise.
  std::filesystem::path results;  ///< See usualResults().
};

/// What is to be done for each command.
class CliActions {
 public:
  /// `command` must outlive this. A signal ends it, see EndOnSignal.
  void add(const CLI::App* command, std::function<int()> action) {
    addStopping(command, [action = std::move(action)] {
      const EndOnSignal end;
      return action();
    });
  }
  /// For a command that stops by itself when a signal comes.
  void addStopping(const CLI::App* command, std::function<int()> action) {
    actions_.emplace_back(command, std::move(action));
  }
  /// For a command whose options `action` takes.
  template <typename Options>
  void add(const CLI::App* command, std::shared_ptr<Options> options, int (*action)(const Options&)) {
    add(command, [options = std::move(options), action] { return action(*options); });
  }
  /// A command whose code, options included, is in another program, by which `become` replaces this process
  /// as soon as the command's name is read.
  void handOver(CLI::App* command, const std::function<void()>& become) {
    command->preparse_callback([become](std::size_t) { become(); });
    elsewhere_.emplace_back(command->get_name(), become);
  }
  [[nodiscard]] const auto& elsewhere() const { return elsewhere_; }
  /// Does what was asked for on the command line. Returns its exit code; nullopt if nothing was.
  [[nodiscard]] std::optional<int> run() const {
    for (const auto& [command, action] : actions_) {
      if (command->parsed()) return action();
    }
    return std::nullopt;
  }

 private:
  std::vector<std::pair<const CLI::App*, std::function<int()>>> actions_;
  std::vector<std::pair<std::string, std::function<void()>>> elsewhere_;
};

/// Adds the commands of a program, in the order of its help.
using AddCommands = void (*)(CLI::App& app, const CliProgram& program, CliActions& actions);

/// Whether a program is kerfbench, or has some of its commands.
enum class ProgramPart { kWhole, kSomeCommands };

/// Reads the command line and does what it asks for; help, version and what is wrong with it are told as
/// `kerfbench` tells them, in whichever program. Returns the exit code.
int dispatch(int argc, char** argv, ProgramPart part, AddCommands add_commands);

}  // namespace kerfbench::cli
