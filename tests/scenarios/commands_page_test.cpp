// SPDX-License-Identifier: Apache-2.0
// Page docs/reference/cli.md compared with the programs' --help.
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/docs/key_tables.h"
#include "tests/scenarios/scenario_runs.h"

namespace kerfbench::test {
namespace {

using Options = std::set<std::string>;

/// Long options of the tables of each section, by the section's heading.
std::map<std::string, Options> sectionsOfThePage() {
  std::istringstream page(docs::pageText("cli.md"));
  std::map<std::string, Options> sections;
  std::string heading;
  for (std::string line; std::getline(page, line);) {
    if (line.starts_with("## ")) heading = line.substr(3);
    if (!line.starts_with("| `")) continue;
    const std::string cell = line.substr(0, line.find('|', 2));
    if (const auto at = cell.find("--"); at != std::string::npos)
      sections[heading].insert(cell.substr(at, cell.find('`', at) - at));
    else
      sections[heading];
  }
  return sections;
}

Options optionsIn(const std::string& help) {
  static const std::regex option(R"(\n  (?:-\w,)?(--[a-z0-9-]+))");
  Options options;
  for (auto it = std::sregex_iterator(help.begin(), help.end(), option); it != std::sregex_iterator(); ++it) {
    if ((*it)[1] != "--help") options.insert((*it)[1]);
  }
  return options;
}

std::vector<std::string> subcommandsIn(const std::string& help) {
  std::vector<std::string> commands;
  const auto begin = help.find("Subcommands:\n");
  if (begin == std::string::npos) return commands;
  std::istringstream lines(help.substr(begin));
  static const std::regex command(R"(^  ([a-z-]+)( .*|$))");
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, match, command)) commands.push_back(match[1]);
  }
  return commands;
}

/// Adds every command of a program and of its commands: "run", "calibrate head".
void addCommands(const std::string& name, const std::string& prefix, std::map<std::string, Options>& said) {
  const std::string help = program(name, prefix + " --help").output;
  const auto commands = subcommandsIn(help);
  for (const std::string& each : commands)
    addCommands(name, prefix.empty() ? each : prefix + " " + each, said);
  if (commands.empty()) said[name + " " + prefix] = optionsIn(help);
}

TEST(CommandsPage, HasEveryCommandWithItsOptions) {
  auto page = sectionsOfThePage();
  const Options common = page["kerfplan: common options"];
  std::map<std::string, Options> said;
  addCommands("kerfbench", "", said);
  addCommands("kerfplan", "", said);
  EXPECT_GT(said.size(), 20U);
  for (const auto& [command, options] : said) {
    EXPECT_TRUE(page.contains(command)) << command;
    Options written = page[command];
    if (command.starts_with("kerfplan ")) {
      for (const std::string& option : common) {
        if (options.contains(option)) written.insert(option);
      }
    }
    EXPECT_EQ(written, options) << command;
  }
  for (const auto& [heading, options] : page) {
    if (heading.starts_with("kerfbench ") || heading.starts_with("kerfplan ")) {
      EXPECT_TRUE(said.contains(heading)) << heading << " is no command";
    }
  }
}

}  // namespace
}  // namespace kerfbench::test
