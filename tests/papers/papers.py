#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the command of every equation, figure, table and result of the five papers, and writes docs/reference/papers.md.

tests/papers/rows.toml has the rows. Each names a command that a user can run, what the paper says, and where the command's
output has our figure: a row whose command fails, or whose figure is not found or not within its bounds, ends the page with exit
code 1. A row may take its figure from a page that its command writes, where that takes minutes (`page`).
Exit code: 0 every row holds, 1 one does not, 2 something broke, 64 usage.
"""
import argparse
import os
import re
import shlex
import subprocess
import sys
import tempfile
import tomllib

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "tests", "figures"))
import stamp  # noqa: E402

PAGE = "docs/reference/papers.md"
ROWS = "tests/papers/rows.toml"
KEYS = {"item", "what", "where", "command", "theirs", "ours", "say", "least", "most", "chosen", "page"}
NEEDED = {"item", "what", "where", "command", "theirs", "ours", "chosen"}


class Broken(Exception):
    """A row that does not hold, in words."""


def read_rows(path):
    """Papers with their rows. Raises Broken with everything that is wrong in the file."""
    with open(path, "rb") as opened:
        book = tomllib.load(opened)
    faults = []
    for paper in book["paper"]:
        for row in paper["row"]:
            name = f"{paper['name']} {row.get('item', '?')}"
            faults += [f"{name}: unknown key {key}" for key in sorted(row.keys() - KEYS)]
            faults += [f"{name}: {key} is missing" for key in sorted(NEEDED - row.keys())]
            if ("least" in row or "most" in row) and "(" not in row.get("ours", ""):
                faults.append(f"{name}: bounds need a group in `ours`")
    if faults:
        raise Broken("\n".join(faults))
    return book


class Commands:
    """Runs commands as a user would type them, each once."""

    def __init__(self, build, words, scratch, tell):
        self.build, self.words, self.scratch, self.tell, self.said = build, words, scratch, tell, {}

    def program_of(self, line):
        """What `./bench LINE` comes to on a tree that is built."""
        for name, value in self.words.items():
            line = line.replace(f"${name}", value)
        words = shlex.split(line)
        if words[:1] != ["./bench"]:
            raise Broken(f"`{line}` is not a command of ./bench")
        binary = os.path.join(self.build, "bin")
        if words[1] == "kerfplan":
            return [os.path.join(binary, "kerfplan")] + [self.in_scratch(word) for word in words[2:]]
        if words[1] == "validate":
            return [os.path.join(binary, "kerfbench-validation"), "--quick",
                    "--draft", os.path.join(self.scratch, "draft.md")] + words[2:]
        if words[1] == "run":
            words += ["--no-pictures", "--twin", "fast", "--results-dir", os.path.join(self.scratch, "results")]
        return [os.path.join(binary, "kerfbench")] + [self.in_scratch(word) for word in words[1:]]

    def in_scratch(self, word):
        return os.path.join(self.scratch, word) if word.startswith("results/") else word

    def output(self, line):
        """All that a command line prints; `&&` between several. Each command runs once."""
        return "".join(self.output_of(part) for part in line.split(" && "))

    def output_of(self, command):
        if command not in self.said:
            self.tell(command)
            done = subprocess.run(self.program_of(command), cwd=ROOT, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise Broken(f"`{command}` ends with {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
            self.said[command] = done.stdout + done.stderr
        return self.said[command]


def figure_of(row, commands):
    """Our figure of a row. Raises Broken."""
    if "page" in row:
        with open(os.path.join(ROOT, row["page"]), encoding="utf-8") as opened:
            text = opened.read()
    else:
        text = commands.output(row["command"])
    found = re.search(row["ours"], text, re.MULTILINE)
    if not found:
        raise Broken(f"`{row['ours']}` is not in what `{row['command']}` says:\n{text[-2000:]}")
    if "least" in row or "most" in row:
        value = float(found.group(1))
        if not row.get("least", -float("inf")) <= value <= row.get("most", float("inf")):
            raise Broken(f"{value:g} is out of {row.get('least', '-inf')} … {row.get('most', 'inf')}")
    said = row.get("say", "{}").format(*(found.groups() or (found.group(0),)))
    return " ".join(said.split())


def is_quick(row):
    """Whether the row's command takes no second: it plans, or its figure is taken from a page."""
    return "page" in row or all(part.startswith("./bench kerfplan ") for part in row["command"].split(" && "))


def table_of(paper, commands, faults):
    """One paper's rows as a table."""
    lines = ["| item | what it is | the paper | ours | command | what the paper leaves open, and our choice |",
             "|---|---|---|---|---|---|"]
    for row in paper["row"]:
        try:
            ours = figure_of(row, commands)
        except Broken as broken:
            faults.append(f"{paper['name']} {row['item']}: {broken}")
            ours = "**does not hold**"
        where = row["where"].replace("](", "](../../") if "](" in row["where"] else row["where"]
        cells = [row["item"], f"{row['what']}: {where}", row["theirs"], ours, f"`{row['command']}`", row["chosen"]]
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return lines


def page_of(book, commands, line, faults):
    """The whole page."""
    lines = ["<!-- SPDX-License-Identifier: Apache-2.0 -->",
             f"<!-- Written by ./bench papers. Do not edit: the rows are in {ROWS}. -->",
             "# The five papers, row by row", "",
             "`./bench papers` runs each command of this page, takes our figure from what it prints, and fails if one is missing or out of",
             "its bounds. [References](../references.md) has the papers' titles and where the code uses them. Runs are made with",
             "`--twin fast --no-pictures`; `results/` is the folder of the results.", "",
             line, "", "Words that stand for long options:", "", "```sh"]
    lines += [f"{name}='{value}'" for name, value in commands.words.items()]
    lines.append("```")
    for paper in book["paper"]:
        lines += ["", f"## {paper['name']} · {paper['title']}", ""] + table_of(paper, commands, faults)
        lines += ["", paper["left_out"]] if "left_out" in paper else []
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(prog="./bench papers", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--only", choices=["S0", "S1", "S2", "S3", "S4"], help="the rows of this paper; printed, not written")
    parser.add_argument("--quick", action="store_true", help="the rows that need no run; printed, not written")
    parser.add_argument("--rows", default=os.path.join(ROOT, ROWS), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    line = stamp.line_of("papers", "seeds of the scenarios")
    book = read_rows(arguments.rows)
    for paper in book["paper"]:
        if arguments.quick:
            paper["row"] = [row for row in paper["row"] if is_quick(row)]
    if arguments.only:
        book["paper"] = [paper for paper in book["paper"] if paper["name"] == arguments.only]
    faults = []
    with tempfile.TemporaryDirectory(prefix="kerfbench-papers-") as scratch:
        commands = Commands(arguments.build, book["words"], scratch, lambda text: print(text, file=sys.stderr, flush=True))
        page = page_of(book, commands, line, faults)
    if not (arguments.only or arguments.quick):
        with open(os.path.join(ROOT, PAGE), "w", encoding="utf-8") as opened:
            opened.write(page)
    else:
        print(page)
    for fault in faults:
        print(fault, file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Broken as broken:
        print(broken, file=sys.stderr)
        sys.exit(2)
