#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""run_commands.py SOURCE BIN quick|long|list: runs the command lines of README.md, docs/tutorial and docs/how-to, as commands.toml says.
Every line must be listed there, and every entry must be of a line. A line is what a reader types: `./bench` and the programs are
found, nothing else is replaced. list: how many lines are run in which tier, and why the others are not."""
import collections
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib

source, bin_dir, tier = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve(), sys.argv[3]
LIST = source / "tests/docs_site/commands.toml"
TIERS = ("quick", "long", "excused")
BEGINS = re.compile(r"(\./bench|kerfbench|kerfplan|cmake|cp|apt|podman|git|own-check/\S+)\s|\./bench$")
WORDS_OF_A_COMMENT = re.compile(r"\s+#\s.*$")


def lines_of(page):
    """Command lines of a page, without the comments behind them."""
    fenced, language, joined = False, "", ""
    for line in page.read_text(encoding="utf-8").splitlines():
        if line.startswith("```"):
            fenced, language = not fenced, line[3:]
            continue
        if not (fenced or line.startswith("    ")) or (fenced and language not in ("", "sh", "bash", "console")):
            joined = ""
            continue
        joined += re.sub(r"\s+", " ", WORDS_OF_A_COMMENT.sub("", line)).strip()
        if joined.endswith("\\"):
            joined = joined[:-1].rstrip() + " "
            continue
        whole, joined = joined, ""
        if BEGINS.match(whole):
            yield whole


def pages():
    yield source / "README.md"
    for folder in ("docs/tutorial", "docs/how-to"):
        yield from sorted((source / folder).glob("*.md"))


def is_of(entry, line):
    return line == entry["line"] or ("*" in entry["line"] and fnmatch.fnmatchcase(line, entry["line"]))


def block_of(page, begins):
    """A fenced block of a page."""
    for block in re.findall(r"```yaml\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
        if block.startswith(begins):
            return block
    raise ValueError(f"{page}: no block begins with {begins!r}")


def put_files(folder, files):
    for file in files:
        to = folder / file["name"]
        if "page" in file:
            to.write_text(block_of(source / file["page"], file["begins"]), encoding="utf-8")
        elif "text" in file:
            to.write_text(file["text"], encoding="utf-8")
        elif "lies_at" in file:  # Names in it are relative to where it lies: it is extended, not copied.
            to.write_text(f"extends: {file['copy']}\n", encoding="utf-8")
        else:
            shutil.copy(source / file["copy"], to)


def put_programs(folder):
    """./bench and the programs, as a reader has them; ./bench builds nothing here."""
    (folder / "bench").write_text(f"""#!/bin/sh
case $1 in kerfplan) shift; exec '{bin_dir}/kerfplan' "$@" ;; esac
exec '{bin_dir}/kerfbench' "$@"
""")
    (folder / "bench").chmod(0o755)
    (folder / "fixtures").symlink_to(source / "fixtures")


def run(entry, line, folder):
    environment = dict(os.environ, PATH=f"{bin_dir}:{os.environ['PATH']}", CI="")
    before = os.times()
    done = subprocess.run(["sh", "-c", line], cwd=folder, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    after = os.times()
    cpu_s = after.children_user + after.children_system - before.children_user - before.children_system
    print(f"{done.returncode} after {cpu_s:.1f} CPU s: {line}", flush=True)
    wrong = []
    if done.returncode not in entry.get("exit", [0]):
        wrong.append(f"{line}: exit code {done.returncode}\n{done.stdout[-1000:]}{done.stderr[-1000:]}")
    wrong += [f"{line}: there is no {name}" for name in entry.get("writes", []) if not (folder / name).exists()]
    return wrong


def main():
    listed = tomllib.loads(LIST.read_text(encoding="utf-8"))
    entries = listed["command"]
    found = collections.defaultdict(list)
    wrong, count = [], collections.Counter()
    for page in pages():
        for line in lines_of(page):
            entry = next((e for e in entries if is_of(e, line)), None)
            if entry is None:
                wrong.append(f"{page.relative_to(source)}: commands.toml does not have: {line}")
                continue
            count[entry["tier"]] += 1
            if line not in found[entry["line"]]:
                found[entry["line"]].append(line)
    for entry in entries:
        if entry["line"] not in found:
            wrong.append(f"commands.toml: no page has: {entry['line']}")
        if entry["tier"] not in TIERS or (entry["tier"] == "excused") != bool(entry.get("why")):
            wrong.append(f"commands.toml: {entry['line']}: tier is one of {', '.join(TIERS)}, and `why` excuses")
        if tier == "list" and entry["tier"] == "excused":
            print(f"not run: {entry['line']}: {entry['why']}")
    if tier in ("quick", "long"):
        with tempfile.TemporaryDirectory() as made:
            folder = pathlib.Path(made)
            put_programs(folder)
            put_files(folder, listed["file"])
            for entry in entries:
                for line in found[entry["line"]] if entry["tier"] == tier else []:
                    wrong += run(entry, line, folder)
    for fault in wrong:
        print(fault)
    print(f"{sum(count.values())} command lines: {count['quick']} run in every test, {count['long']} among the long proofs, {count['excused']} excused")
    return 1 if wrong or sum(count.values()) < 60 else 0


sys.exit(main())
