// SPDX-License-Identifier: Apache-2.0
#include "hil/command_line/man_page.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kerfbench::command_line {
namespace {

/// Text as roff prints it: a backslash is none of its commands, a hyphen can be copied, and no line begins
/// with a dot or a quote.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool begins = out.empty() || out.back() == '\n';
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

/// Lines of a help text are broken for a terminal; roff fills its own.
std::string filled(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  return roff(text);
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

/// First clause of a help text, for the line that apropos(1) finds.
std::string brief(const std::string& help) {
  std::string text = help.substr(0, help.find_first_of(":.\n"));
  if (!text.empty()) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return roff(text);
}

std::string valueOf(const OptionText& option) {
  if (!option.choices.empty()) return fmt::format("{}", fmt::join(option.choices, "|"));
  return option.value;
}

std::string optionLines(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + fmt::format("\\fB{}\\fR", roff(name));
  std::string text = ".TP\n" + names;
  if (!option.argument && option.takesValue()) text += fmt::format(" \\fI{}\\fR", roff(valueOf(option)));
  if (option.several) text += " ...";
  text += "\n" + (option.help.empty() ? "\\&" : filled(option.help));
  if (!option.standard.empty()) text += roff(fmt::format(" [default: {}]", option.standard));
  return text + "\n";
}

std::string synopsis(const CommandTree& tree, const std::string& title) {
  std::string text = ".B " + roff(title) + "\n[\\fIOPTIONS\\fR]";
  for (const OptionText& option : tree.options) {
    if (!option.argument) continue;
    const std::string word =
        fmt::format("\\fI{}\\fR{}", roff(option.names.front()), option.several ? "..." : "");
    text += option.required ? " " + word : " [" + word + "]";
  }
  if (!tree.commands.empty()) text += " \\fICOMMAND\\fR";
  return text + "\n";
}

std::string pageOf(const CommandTree& tree, const std::string& title, const CommandTree& program,
                   const std::string& version) {
  std::string name = title;
  std::ranges::replace(name, ' ', '-');
  std::string text = fmt::format(".TH {} 1 \"\" \"Kerfbench {}\" \"Kerfbench\"\n.SH NAME\n{} \\- {}\n",
                                 roff(upper(name)), version, roff(name), brief(tree.help));
  text += ".SH SYNOPSIS\n" + synopsis(tree, title) + ".SH DESCRIPTION\n" + filled(tree.help) + "\n";
  if (!tree.commands.empty()) {
    text += ".SH COMMANDS\n";
    for (const CommandTree& command : tree.commands)
      text += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(command.name), filled(command.help));
  }
  if (!tree.options.empty()) text += ".SH OPTIONS\n";
  for (const OptionText& option : tree.options) text += optionLines(option);
  if (!program.footer.empty()) text += ".SH EXIT STATUS\n" + filled(program.footer) + "\n";
  text += ".SH SEE ALSO\n";
  text += title == program.name
              ? "Pages of the commands are named like \\fB" + roff(program.name) + "\\-COMMAND\\fR(1).\n"
              : "\\fB" + roff(program.name) + "\\fR(1)\n";
  return text;
}

void addPages(const CommandTree& tree, const std::string& title, const CommandTree& program,
              const std::string& version, std::vector<ManPage>& pages) {
  if (tree.elsewhere) return;
  std::string name = title;
  std::ranges::replace(name, ' ', '-');
  pages.push_back({name, pageOf(tree, title, program, version)});
  for (const CommandTree& command : tree.commands)
    addPages(command, title + " " + command.name, program, version, pages);
}

}  // namespace

std::vector<ManPage> manPages(const CommandTree& program, const std::string& version) {
  std::vector<ManPage> pages;
  addPages(program, program.name, program, version, pages);
  return pages;
}

}  // namespace kerfbench::command_line
