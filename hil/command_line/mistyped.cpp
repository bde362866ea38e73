// SPDX-License-Identifier: Apache-2.0
#include "hil/command_line/mistyped.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "hil/base/near_word.h"
#include "hil/base/text.h"

namespace kerfbench::command_line {
namespace {

const CommandTree* below(const CommandTree& tree, std::string_view name) {
  const auto found = std::ranges::find(tree.commands, name, &CommandTree::name);
  return found == tree.commands.end() ? nullptr : &*found;
}

bool hasArguments(const CommandTree& tree) {
  return std::ranges::any_of(tree.options, [](const OptionText& option) { return option.argument; });
}

std::vector<std::string> optionsAt(const std::vector<const CommandTree*>& path) {
  std::vector<std::string> names;
  for (auto tree = path.rbegin(); tree != path.rend(); ++tree) {
    for (const OptionText& option : (*tree)->options) {
      if (!option.argument) names.insert(names.end(), option.names.begin(), option.names.end());
    }
  }
  return names;
}

const OptionText* optionAt(const std::vector<const CommandTree*>& path, std::string_view name) {
  for (auto tree = path.rbegin(); tree != path.rend(); ++tree) {
    for (const OptionText& option : (*tree)->options) {
      if (!option.argument && std::ranges::find(option.names, name) != option.names.end()) return &option;
    }
  }
  return nullptr;
}

/// "-5" and "-.5" are values.
bool looksLikeOption(std::string_view word) {
  return word.size() > 1 && word[0] == '-' && word[1] != '.' && (word[1] < '0' || word[1] > '9');
}

std::string pathText(const std::vector<const CommandTree*>& path) {
  std::string text;
  for (const CommandTree* tree : path) text += (text.empty() ? "" : " ") + tree->name;
  return text;
}

std::string noCommand(const std::vector<const CommandTree*>& path, const std::string& word) {
  std::vector<std::string> names;
  for (const CommandTree& command : path.back()->commands) names.push_back(command.name);
  return fmt::format("{}: there is no command {}.{}", pathText(path), base::inQuotes(word),
                     base::didYouMean(word, names));
}

/// The path that the words take, up to the first that is wrong; a sentence about that one.
std::pair<std::vector<const CommandTree*>, std::optional<std::string>> follow(
    const CommandTree& program, const std::vector<std::string>& words) {
  std::vector<const CommandTree*> path{&program};
  const OptionText* open = nullptr;
  for (const std::string& word : words) {
    if (word == "--" || path.back()->elsewhere) break;
    if (open != nullptr && !looksLikeOption(word)) {
      if (!open->several) open = nullptr;
      continue;
    }
    open = nullptr;
    if (word.empty()) continue;
    if (looksLikeOption(word)) {
      const std::string name = word.substr(0, word.find('='));
      const OptionText* option = optionAt(path, name);
      // "-q5" and "-qj4" are for the parser.
      if (option == nullptr && name.starts_with("--"))
        return {path, fmt::format("{}: there is no option {}.{}", pathText(path), base::inQuotes(name),
                                  base::didYouMean(name, optionsAt(path)))};
      if (option != nullptr && option->takesValue() && name.size() == word.size()) open = option;
      continue;
    }
    if (const CommandTree* command = below(*path.back(), word); command != nullptr) {
      path.push_back(command);
      continue;
    }
    if (!path.back()->commands.empty() && !hasArguments(*path.back())) return {path, noCommand(path, word)};
  }
  return {path, std::nullopt};
}

}  // namespace

std::optional<std::string> mistypedWord(const CommandTree& program, const std::vector<std::string>& words) {
  return follow(program, words).second;
}

std::string commandNamed(const CommandTree& program, const std::vector<std::string>& words) {
  return pathText(follow(program, words).first);
}

}  // namespace kerfbench::command_line
