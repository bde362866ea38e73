// SPDX-License-Identifier: Apache-2.0
#include "hil/command_line/dialogue_cli.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "hil/base/atomic_file.h"
#include "hil/base/colour.h"
#include "hil/base/exit_codes.h"
#include "hil/base/near_word.h"
#include "hil/base/terminal.h"
#include "hil/base/text.h"
#include "hil/base/utf8.h"
#include "hil/command_line/command_tree_cli.h"
#include "hil/command_line/completion.h"
#include "hil/command_line/man_page.h"
#include "hil/command_line/mistyped.h"

namespace kerfbench::command_line {

namespace {

/// A variable that is not set is an empty word: the option would count as not given, and a release that
/// nobody meant would be judged in place of the named one.
void refuseEmptyWords(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    // Where no word need follow an option, its absence is an empty word, too.
    if (option->count() == 0 || option->get_items_expected_min() == 0) continue;
    if (std::ranges::find(option->results(), std::string()) != option->results().end())
      throw CLI::ValidationError(option->get_name(), "its word is empty");
  }
  for (const CLI::App* command : app.get_subcommands()) refuseEmptyWords(*command);
}

}  // namespace

Dialogue::Dialogue(CLI::App& app, std::string version) : app_(app), version_(std::move(version)) {
  app.add_option("--color", colour_,
                 "Colours: auto (on a terminal, unless NO_COLOR is set), always or never; with any command")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->capture_default_str();
  completion_ = app.add_subcommand("completion",
                                   "Print the script by which a shell completes this program's commands and "
                                   "options");
  completion_->add_option("SHELL", shell_, "The shell")
      ->check(CLI::IsMember({"bash", "zsh", "fish"}))
      ->required();
  man_ = app.add_subcommand("man", "Print the man page of the program or of a command");
  man_->add_option("COMMAND", page_, "Words of the command; otherwise the program");
  man_->add_option("--out", folder_, "Folder to write all pages to, instead");
}

void Dialogue::handOver(const std::string& command, std::function<void()> become) {
  elsewhere_[command] = std::move(become);
}

CommandTree Dialogue::tree() const {
  CommandTree tree = treeOf(app_);
  for (CommandTree& command : tree.commands) command.elsewhere = elsewhere_.contains(command.name);
  return tree;
}

int Dialogue::complete(const std::vector<std::string>& words) const {
  for (const std::string& word : words) {
    if (word.starts_with("-")) continue;
    // The last word may be about to become another.
    if (const auto found = elsewhere_.find(word); found != elsewhere_.end() && &word != &words.back())
      found->second();
    break;
  }
  base::toTerminal(stdout, completionsFor(tree(), words));
  return 0;
}

int Dialogue::tellFault(const CLI::ParseError& fault, const std::vector<std::string>& words) const {
  const CommandTree all = tree();
  const std::string command = commandNamed(all, words);
  const auto told = mistypedWord(all, words);
  base::toTerminal(stderr, told ? *told + "\n" : fmt::format("{}: {}\n", command, fault.what()));
  base::toTerminal(stderr, fmt::format("{} --help lists what there is.\n", command));
  return base::kExitUsage;
}

int Dialogue::tellPages() const {
  const std::vector<ManPage> pages = manPages(tree(), version_);
  if (!folder_.empty()) {
    std::filesystem::create_directories(folder_);
    for (const ManPage& page : pages) {
      if (only_commands_ &&
          (page.name == app_.get_name() || page.name.ends_with("-completion") || page.name.ends_with("-man")))
        continue;
      base::writeFileAtomically(folder_ / (page.name + ".1"), page.text);
    }
    return 0;
  }
  if (!page_.empty()) {
    if (const auto found = elsewhere_.find(page_.front()); found != elsewhere_.end()) found->second();
  }
  const std::string name =
      fmt::format("{}{}{}", app_.get_name(), page_.empty() ? "" : "-", fmt::join(page_, "-"));
  const auto page = std::ranges::find(pages, name, &ManPage::name);
  if (page == pages.end()) {
    std::vector<std::string> names;
    for (const ManPage& each : pages) names.push_back(each.name);
    base::toTerminal(stderr, fmt::format("there is no page {}.{}\n", name, base::didYouMean(name, names)));
    return base::kExitUsage;
  }
  base::toTerminalAsItIs(stdout, page->text);
  return 0;
}

std::optional<int> Dialogue::read(int argc, char** argv) {
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (!words.empty() && words.front() == kAskCompletion) return complete({words.begin() + 1, words.end()});
  if (words.empty()) {
    // In a pipeline a command that has got lost must not look like a PASS.
    base::toTerminalAsItIs(stderr, app_.help());
    return base::kExitUsage;
  }
  for (const std::string& word : words) {
    if (!base::hasControl(word)) continue;
    // A file of such a name would bring its line feeds and escape sequences into every message and report.
    base::toTerminal(stderr,
                     fmt::format("{}: '{}' has a control character, which no word or file name may have\n",
                                 app_.get_name(), base::printable(word, 200)));
    return base::kExitUsage;
  }
  try {
    app_.parse(argc, argv);
    refuseEmptyWords(app_);
  } catch (const CLI::Success& asked) {
    return app_.exit(asked);
  } catch (const CLI::ParseError& fault) {
    return tellFault(fault, words);
  }
  base::chooseColour(colour_ == "always"  ? base::ColourChoice::kAlways
                     : colour_ == "never" ? base::ColourChoice::kNever
                                          : base::ColourChoice::kAuto);
  if (completion_->parsed()) {
    base::toTerminalAsItIs(stdout, completionScript(shell_, app_.get_name()).value_or(""));
    return 0;
  }
  if (man_->parsed()) return tellPages();
  return std::nullopt;
}

}  // namespace kerfbench::command_line
