#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the build targets that some tests need: select_targets.py BUILD CTEST-ARGUMENTS...

A test needs whatever its command names that the build makes; what these need in turn the build knows. Prints nothing if
no test is selected. Ends with 1 if ctest or the build cannot be asked.
"""
import json
import os
import re
import subprocess
import sys


def asked(command):
    answer = subprocess.run(command, capture_output=True, text=True)
    if answer.returncode != 0:
        sys.exit(f"{' '.join(command)}: {answer.stderr.strip() or answer.stdout.strip()}")
    return answer.stdout


def commands(build):
    """The words of each test's command, by its name. From the files that ctest reads: ctest itself leaves out the command of a
    program that is not built yet."""
    found = {}
    for folder, _, files in os.walk(build):
        if "CTestTestfile.cmake" not in files:
            continue
        with open(os.path.join(folder, "CTestTestfile.cmake"), encoding="utf-8") as file:
            for name, words in re.findall(r"^add_test\(\[=*\[(.*?)\]=*\]\s+(.*)\)$", file.read(), re.MULTILINE):
                found[name] = [re.sub(r"\\(.)", r"\1", word) for word in re.findall(r'"((?:[^"\\]|\\.)*)"', words)]
    return found


def main():
    build = os.path.realpath(sys.argv[1])
    selected = json.loads(asked(["ctest", "--test-dir", build, "--show-only=json-v1", *sys.argv[2:]]))
    made = {line.rsplit(": ", 1)[0] for line in asked(["ninja", "-C", build, "-t", "targets", "all"]).splitlines()}
    command_of = commands(build)
    needed = set()
    for test in selected["tests"]:
        if test["name"] not in command_of:
            sys.exit(f"{build}: the command of test {test['name']} is not where ctest has it")
        wanted = list(command_of[test["name"]])
        for property in test.get("properties", []):
            if property["name"] == "REQUIRED_FILES":
                wanted += property["value"]
        # A command may be one word of a shell's line, or an option with its value.
        words = [word.strip("'\"") for argument in wanted for word in argument.replace("=", " ").split()]
        for word in words:
            path = os.path.relpath(word, build) if os.path.isabs(word) else word
            if path in made:
                needed.add(path)
    print(" ".join(sorted(needed)))


main()
