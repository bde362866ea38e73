// SPDX-License-Identifier: Apache-2.0
#include "hil/command_line/completion.h"

#include <algorithm>

namespace kerfbench::command_line {
namespace {

/// First line of a help text, which a shell shows beside a word.
std::string firstLine(const std::string& text) { return text.substr(0, text.find('\n')); }

const CommandTree* commandOf(const CommandTree& tree, const std::string& name) {
  const auto found = std::ranges::find(tree.commands, name, &CommandTree::name);
  return found == tree.commands.end() ? nullptr : &*found;
}

/// Where the words before the last lead.
struct Position {
  std::vector<const CommandTree*> path;  ///< From the program to the command; never empty.
  const OptionText* open{};              ///< Option whose value comes next; null: none.
  std::size_t arguments{};               ///< Arguments of the command so far.
  bool arguments_only{false};            ///< After "--".
};

/// The option may be one of a command above.
const OptionText* optionOf(const Position& at, const std::string& name) {
  for (auto tree = at.path.rbegin(); tree != at.path.rend(); ++tree) {
    for (const OptionText& option : (*tree)->options) {
      if (!option.argument && std::ranges::find(option.names, name) != option.names.end()) return &option;
    }
  }
  return nullptr;
}

void take(Position& at, const std::string& word) {
  if (at.open != nullptr) {
    at.open = nullptr;
  } else if (!at.arguments_only && word == "--") {
    at.arguments_only = true;
  } else if (!at.arguments_only && word.starts_with("-") && word != "-") {
    const OptionText* option = optionOf(at, word);
    if (option != nullptr && option->takesValue()) at.open = option;
  } else if (const CommandTree* command = commandOf(*at.path.back(), word);
             command != nullptr && at.arguments == 0) {
    at.path.push_back(command);
  } else {
    ++at.arguments;
  }
}

class Answer {
 public:
  explicit Answer(std::string begun) : begun_(std::move(begun)) {}
  void offer(const std::string& word, const std::string& meaning) {
    if (word.starts_with(begun_)) text_ += word + "\t" + firstLine(meaning) + "\n";
  }
  void offerFiles() { text_ += std::string(kFilesToo) + "\n"; }
  [[nodiscard]] std::string text() const { return text_; }

 private:
  std::string begun_;
  std::string text_;
};

void offerValues(const OptionText& option, Answer& answer) {
  for (const std::string& choice : option.choices) answer.offer(choice, "");
  if (option.takesFile()) answer.offerFiles();
}

void offerOptions(const Position& at, Answer& answer) {
  for (auto tree = at.path.rbegin(); tree != at.path.rend(); ++tree) {
    for (const OptionText& option : (*tree)->options) {
      if (option.argument) continue;
      for (const std::string& name : option.names) {
        if (name.starts_with("--")) answer.offer(name, option.help);
      }
    }
  }
}

void offerArgument(const Position& at, Answer& answer) {
  std::size_t left = at.arguments;
  for (const OptionText& option : at.path.back()->options) {
    if (!option.argument) continue;
    if (left == 0 || option.several) return offerValues(option, answer);
    --left;
  }
}

}  // namespace

std::string completionsFor(const CommandTree& program, std::vector<std::string> words) {
  if (words.empty()) words.emplace_back();
  Position at{.path = {&program}};
  for (std::size_t i = 0; i + 1 < words.size(); ++i) take(at, words[i]);
  const std::string& begun = words.back();
  // "--twin=fa": the value of an option, with its name before it.
  const std::size_t equals = begun.find('=');
  if (at.open == nullptr && begun.starts_with("--") && equals != std::string::npos) {
    const OptionText* option = optionOf(at, begun.substr(0, equals));
    Answer answer(begun);
    if (option != nullptr) {
      for (const std::string& choice : option->choices)
        answer.offer(begun.substr(0, equals + 1) + choice, "");
    }
    return answer.text();
  }
  Answer answer(begun);
  if (at.open != nullptr) {
    offerValues(*at.open, answer);
  } else if (begun.starts_with("-") && !at.arguments_only) {
    offerOptions(at, answer);
  } else {
    if (at.arguments == 0) {
      for (const CommandTree& command : at.path.back()->commands) answer.offer(command.name, command.help);
    }
    offerArgument(at, answer);
  }
  return answer.text();
}

}  // namespace kerfbench::command_line
