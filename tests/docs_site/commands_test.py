#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""commands_test.py SOURCE KERFBENCH INSTRUMENT KERFPLAN: every command line in the documents names commands and options that there are, and shipped
files that are there. The programs are asked as a shell asks them (--complete); nothing is run."""
import functools
import glob
import os
import re
import shlex
import subprocess
import sys

source, kerfbench, _, kerfplan = sys.argv[1:5]
faults = []
PROGRAMS = {"kerfbench": kerfbench, "kerfplan": kerfplan}


@functools.lru_cache(maxsize=None)
def offered(program, words, begun):
    """Words that the program offers there, and whether a file may stand there."""
    done = subprocess.run([PROGRAMS[program], "--complete", *words, begun], capture_output=True, text=True, check=True)
    return {line.split("\t")[0] for line in done.stdout.splitlines()}


def commands_in(text):
    """Lines of code, indented or fenced, that begin with a program, as (line, words)."""
    fenced = False
    joined = ""
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
            continue
        if not (fenced or line.startswith("    ")):
            joined = ""
            continue
        joined += line.strip()
        if joined.endswith("\\"):
            joined = joined[:-1]
            continue
        whole, joined = joined, ""
        if re.match(r"(\./bench|(?:sudo )?kerfbench|kerfplan)\s", whole):
            yield number, whole


def words_of(line):
    """What stands before a pipe, a comment or another command."""
    try:
        words = shlex.split(line, comments=True)
    except ValueError:
        return None
    for i, word in enumerate(words):
        if word in ("|", "||", "&&", ">", "&", "2>") or re.match(r"\d?>", word):
            return words[:i]
        if word.endswith(";"):
            return words[:i] + [word[:-1]]
    return words


@functools.lru_cache(maxsize=None)
def bench_commands():
    with open(os.path.join(source, "bench"), encoding="utf-8") as file:
        return set(re.findall(r"^  ([a-z-]+)\)$", file.read(), re.MULTILINE))


def check_words(place, program, words):
    path = ()
    # Two levels of commands at most.
    while words and words[0] in offered(program, path, "") and not words[0].startswith("-") and len(path) < 2:
        path += (words[0],)
        words = words[1:]
    if not path:
        if words and not words[0].startswith("-"):
            faults.append(f"{place}: {program} has no command {words[0]}")
        return
    known = offered(program, path, "--")
    for word in words:
        option = word.split("=")[0]
        if re.fullmatch(r"--[a-z0-9-]+", option) and option not in known and option not in ("--help", "--version"):
            faults.append(f"{place}: {program} {' '.join(path)} has no option {option}")


def check_files(place, words):
    for word in words:
        if word.startswith("fixtures/") and not glob.glob(os.path.join(source, word)):
            faults.append(f"{place}: there is no {word}")
        shipped = word.removeprefix("/usr/share/kerfbench/")
        if shipped != word and not shipped.startswith("ci/") and not glob.glob(os.path.join(source, "fixtures", shipped)):
            faults.append(f"{place}: the package has no {word}")


def main():
    listed = subprocess.run(["git", "-C", source, "ls-files", "*.md"], capture_output=True, text=True, check=True)
    count = 0
    for page in listed.stdout.split():
        # What was is not mended.
        if page.startswith("docs/explanation/decisions") or page == "CHANGELOG.md" or not os.path.isfile(os.path.join(source, page)):
            continue
        with open(os.path.join(source, page), encoding="utf-8") as file:
            text = file.read()
        for number, line in commands_in(text):
            words = words_of(line)
            # A placeholder stands for something of the reader's.
            if not words or any("…" in w or "..." in w for w in words):
                continue
            count += 1
            place = f"{page}:{number}"
            words = words[1:] if words[0] == "sudo" else words
            check_files(place, words)
            program, words = words[0], words[1:]
            if program == "./bench":
                if not words or words[0].startswith("-") or words[0] in bench_commands() - {"kerfplan"}:
                    continue
                program = "kerfbench"
                if words[0] == "kerfplan":
                    program, words = "kerfplan", words[1:]
            check_words(place, program, words)
    for fault in faults:
        print(fault)
    print(f"{count} command lines, {len(faults)} faults")
    sys.exit(1 if faults or count < 50 else 0)


main()
