// SPDX-License-Identifier: Apache-2.0
#include "hil/command_line/command_tree_cli.h"

#include <string>
#include <utility>

namespace kerfbench::command_line {
namespace {

/// Words in the first braces of "TEXT:{reference,fast}" or "ENUM:value in {a->0,b->1} OR {0,1}".
std::vector<std::string> choicesIn(const std::string& type) {
  std::vector<std::string> choices;
  const auto begin = type.find('{'), end = type.find('}');
  if (begin == std::string::npos || end == std::string::npos) return choices;
  std::string word;
  for (const char c : type.substr(begin + 1, end - begin - 1) + ",") {
    if (c != ',') {
      word += c;
      continue;
    }
    choices.push_back(word.substr(0, word.find("->")));
    word.clear();
  }
  return choices;
}

OptionText textOf(const CLI::Option& option) {
  OptionText text;
  text.argument = option.get_positional();
  if (text.argument) text.names.push_back(option.get_name(true));
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  const bool takes_value = option.get_items_expected_max() > 0;
  const std::string type = takes_value ? option.get_type_name() : "";
  text.choices = choicesIn(type);
  text.value = text.choices.empty() ? type : type.substr(0, type.find(':'));
  text.help = option.get_description();
  text.standard = takes_value ? option.get_default_str() : "";
  text.required = option.get_required();
  text.several = option.get_items_expected_max() > 1;
  return text;
}

}  // namespace

CommandTree treeOf(const CLI::App& app) {
  CommandTree tree{.name = app.get_name(), .help = app.get_description(), .footer = app.get_footer()};
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) tree.options.push_back(textOf(*option));
  }
  for (const CLI::App* command :
       app.get_subcommands([](const CLI::App* c) { return !c->get_group().empty(); }))
    tree.commands.push_back(treeOf(*command));
  return tree;
}

}  // namespace kerfbench::command_line
