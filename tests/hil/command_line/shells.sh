#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# shells.sh BIN: has each shell that is installed complete words of kerfbench and kerfplan as at its prompt, without one.
set -eu
bin=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
PATH=$bin:$PATH
export PATH
cd "$work"
touch plate.yaml "a plate.yaml"
failed=0
# expect SHELL LINE WANTED GOT: every wanted word is a line of what was got.
expect() {
  for word in $3; do
    if ! printf '%s\n' "$4" | grep -qxF -- "$word"; then
      printf '%s: "%s" completes to this, without %s:\n%s\n' "$1" "$2" "$word" "$4"
      failed=1
    fi
  done
}

# try SHELL: the same lines in each.
try() {
  expect "$1" 'kerfbench ru' 'run' "$("complete_$1" kerfbench ru)"
  expect "$1" 'kerfbench run --se' '--seed' "$("complete_$1" kerfbench run --se)"
  expect "$1" 'kerfbench run --twin ' 'reference fast' "$("complete_$1" kerfbench run --twin '')"
  # In the other program, to which kerfbench hands over.
  expect "$1" 'kerfbench calibrate he' 'head' "$("complete_$1" kerfbench calibrate he)"
  expect "$1" 'kerfbench calibrate head --mach' '--machine' "$("complete_$1" kerfbench calibrate head --mach)"
  expect "$1" 'kerfplan library s' 'show' "$("complete_$1" kerfplan library s)"
  expect "$1" 'kerfbench run pl' 'plate.yaml' "$("complete_$1" kerfbench run pl)"
}

# As bash does it at the prompt: the words, the number of the last, and the function that is registered.
complete_bash() {
  "$bin/$1" completion bash >completion.bash
  bash --norc --noprofile -c '
    . ./completion.bash
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMP_LINE="$*" COMP_POINT=${#COMP_LINE}
    function=$(complete -p "$1" | sed "s/.*-F \([^ ]*\).*/\1/")
    "$function" "$1" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD-1]}" 2>/dev/null
    printf "%s\n" "${COMPREPLY[@]}"' bash "$@"
}
# Its completion system runs in a pseudo-terminal of its own; the words come back as compadd gets them.
complete_zsh() {
  "$bin/$1" completion zsh >"_$1"
  zsh -f -c '
    autoload -Uz compinit; compinit -u -D
    words=("$@") CURRENT=$#
    # What would be offered, one a line.
    _describe() { local list=$2; for each in "${(@P)list}"; do print -r -- "${each%%:*}"; done }
    _files() { print -rl -- "${words[CURRENT]}"*(N) }
    source "./_$1"
    "_$1"' zsh "$@"
}
complete_fish() {
  "$bin/$1" completion fish >completion.fish
  line=
  for word in "$@"; do line="$line${line:+ }$word"; done
  fish --no-config -c 'source completion.fish; complete -C "$argv"' "$line" | cut -f 1
}

tried=
for shell in bash zsh fish; do
  if command -v "$shell" >/dev/null 2>&1; then
    try "$shell"
    tried="$tried $shell"
  else
    echo "$shell is not installed: not tried"
  fi
done
# Behind '=' bash completes the value alone, and a name with a blank stays one word.
expect bash 'kerfbench run --twin=f' fast "$(complete_bash kerfbench run --twin = f)"
got=$(complete_bash kerfbench lint 'a p')
[ "$got" = 'a plate.yaml' ] || { printf 'bash: a name with a blank becomes: %s\n' "$got"; failed=1; }
echo "tried:$tried"
exit "$failed"
