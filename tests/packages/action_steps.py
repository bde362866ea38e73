#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""action_steps.py SOURCE FOLDER: the shell steps of action.yml as NAME.sh in a folder. Holds the file to what a composite action may have, and to
the rule that no input is part of a script's text."""
import os
import re
import sys


def steps(text):
    """Name and script of each step with `run`, by the indentation of this one file."""
    for block in re.split(r"^    - name: ", text, flags=re.MULTILINE)[1:]:
        name = block.splitlines()[0]
        script = re.search(r"^      run: (\|\n(?:(?: {8}.*)?\n)*|.*\n?)", block, re.MULTILINE)
        if script is None:
            continue
        body = script.group(1)
        if body.startswith("|"):
            body = "".join(line[8:] if line.strip() else line for line in body.splitlines(keepends=True)[1:])
        if "shell: bash" not in block:
            sys.exit(f"{name}: a composite action's step names its shell")
        yield name, body


def main():
    source, folder = sys.argv[1:]
    with open(os.path.join(source, "action.yml"), encoding="utf-8") as file:
        text = file.read()
    if not re.search(r"^runs:\n  using: composite$", text, re.MULTILINE):
        sys.exit("action.yml is no composite action")
    os.makedirs(folder)
    found = list(steps(text))
    if [name for name, _ in found] != ["Install", "Run", "Comment", "Verdict"]:
        sys.exit(f"action.yml has other steps: {[name for name, _ in found]}")
    for name, body in found:
        if "${{" in body:
            sys.exit(f"{name}: an input is part of the script: somebody else's text would be run")
        with open(os.path.join(folder, name + ".sh"), "w", encoding="utf-8") as file:
            file.write(body)


main()
