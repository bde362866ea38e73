// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "hil/command_line/completion.h"

namespace kerfbench::command_line {
namespace {

// The program itself knows its commands and options: the scripts only ask it, so they are never out of date.
// PROGRAM stands for its name.

constexpr const char* kBash = R"sh(# bash completion for PROGRAM
_PROGRAM() {
  local IFS=$'\n' line
  COMPREPLY=()
  # bash parts words at '=' and ':': the program gets the line's words as they were typed.
  local words=() word= i
  for ((i = 1; i <= COMP_CWORD; i++)); do
    if [[ ${COMP_WORDS[i]} == = && $i -gt 1 ]]; then
      words[${#words[@]}-1]+='='
    elif [[ $i -gt 2 && ${COMP_WORDS[i-1]} == = ]]; then
      words[${#words[@]}-1]+=${COMP_WORDS[i]}
    else
      words+=("${COMP_WORDS[i]}")
    fi
  done
  local current=${COMP_WORDS[COMP_CWORD]}
  [[ $current == = ]] && current=
  while IFS= read -r line; do
    if [[ $line == :files ]]; then
      COMPREPLY+=($(compgen -f -- "$current"))
      compopt -o filenames 2>/dev/null
    else
      word=${line%%$'\t'*}
      # Behind '=' bash completes the value alone.
      [[ ${words[${#words[@]}-1]} == --*=* ]] && word=${word#*=}
      COMPREPLY+=("$word")
    fi
  done < <("${COMP_WORDS[0]}" --complete "${words[@]}" 2>/dev/null)
}
complete -F _PROGRAM PROGRAM
)sh";

constexpr const char* kZsh = R"sh(#compdef PROGRAM
# zsh completion for PROGRAM
_PROGRAM() {
  local -a candidates
  local line word meaning files=
  for line in "${(@f)$("${words[1]}" --complete "${(@)words[2,CURRENT]}" 2>/dev/null)}"; do
    if [[ $line == :files ]]; then
      files=1
    elif [[ -n $line ]]; then
      word=${line%%$'\t'*}
      meaning=${line#*$'\t'}
      candidates+=("${word//:/\\:}${meaning:+:$meaning}")
    fi
  done
  (( ${#candidates} )) && _describe 'PROGRAM' candidates
  [[ -n $files ]] && _files
  (( ${#candidates} )) || [[ -n $files ]]
}
if [[ ${funcstack[1]} == _PROGRAM ]]; then
  _PROGRAM "$@"
else
  compdef _PROGRAM PROGRAM
fi
)sh";

constexpr const char* kFish = R"sh(# fish completion for PROGRAM
function __PROGRAM_complete
    set -l words (commandline -opc) (commandline -ct)
    set -l current (commandline -ct)
    for line in (command $words[1] --complete $words[2..-1] 2>/dev/null)
        if test "$line" = :files
            __fish_complete_path $current
        else
            echo $line
        end
    end
end
complete -c PROGRAM -f -a '(__PROGRAM_complete)'
)sh";

}  // namespace

std::optional<std::string> completionScript(std::string_view shell, const std::string& program) {
  static const std::map<std::string_view, const char*> kScripts{
      {"bash", kBash}, {"zsh", kZsh}, {"fish", kFish}};
  const auto script = kScripts.find(shell);
  if (script == kScripts.end()) return std::nullopt;
  constexpr std::string_view kName = "PROGRAM";
  std::string text = script->second;
  for (std::size_t at = text.find(kName); at != std::string::npos; at = text.find(kName, at + program.size()))
    text.replace(at, kName.size(), program);
  return text;
}

}  // namespace kerfbench::command_line
