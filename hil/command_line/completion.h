// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/command_line/command_tree.h"

namespace kerfbench::command_line {

/// Argument by which a completion script asks the program: "kerfbench --complete run --see".
inline constexpr const char* kAskCompletion = "--complete";
/// Line of an answer that lets the shell complete names of files.
inline constexpr const char* kFilesToo = ":files";

/// Answer to a shell: lines "word<TAB>what it means", and kFilesToo where a file may stand. `words` are those
/// behind the program's name, the last of them the one to complete (empty, or begun); a program that is given
/// none completes an empty word.
std::string completionsFor(const CommandTree& program, std::vector<std::string> words);

/// Script that lets a shell ask `program` for completions, or nullopt for a shell that is not known: bash,
/// zsh, fish.
std::optional<std::string> completionScript(std::string_view shell, const std::string& program);

}  // namespace kerfbench::command_line
