#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutation of the judge: puts one known fault after the other into hil/vision and hil/inspect, and sees whether the
tests notice.

A mutant counts as killed if a test fails or crashes; one that makes a test run for ever is counted apart, and one that
the compiler refuses is no mutant. RESULTS.md is written anew; with --only, the rows of the mutants that were tried, and
its figures stay as old as the rows that are kept.
Ends with 0 if at least 90 % of RESULTS.md are killed by a failing test and each survivor is explained in SURVIVORS.md,
1 if not, 2 if nothing could be measured, 64 for a wrong command line, 65 for a bad list.
"""
import argparse
import collections
import concurrent.futures
import fnmatch
import os
import queue
import re
import subprocess
import sys
import tomllib

from workshop import Broken, Build, Refused, Workshop, first_failure

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.append(os.path.join(ROOT, "tests", "figures"))
import stamp

PAGE = os.path.join(HERE, "RESULTS.md")
LEAST_SHARE = 0.90
KILLED, TIMED_OUT, SURVIVED, REFUSED = "killed", "timed out", "survived", "refused by the compiler"
RAW = argparse.RawDescriptionHelpFormatter
KEYS = {"name", "file", "find", "put", "what"}

Outcome = collections.namedtuple("Outcome", "mutant fate by")


def read_list(path):
    """Mutants and suites of a list, and all its faults."""
    with open(path, "rb") as file:
        data = tomllib.load(file)
    mutants, faults, names = data.get("mutant", []), [], collections.Counter()
    for number, mutant in enumerate(mutants, 1):
        name = mutant.get("name", f"mutant {number}")
        names[name] += 1
        if missing := KEYS - mutant.keys():
            faults.append(f"{name}: without {', '.join(sorted(missing))}")
            continue
        if unknown := mutant.keys() - KEYS - {"expect"}:
            faults.append(f"{name}: unknown {', '.join(sorted(unknown))}")
        if mutant["find"] == mutant["put"]:
            faults.append(f"{name}: changes nothing")
        if not suites_of(mutant, data.get("suite", [])):
            faults.append(f"{name}: no suite tests {mutant['file']}")
        try:
            with open(os.path.join(ROOT, mutant["file"]), encoding="utf-8") as file:
                count = file.read().count(mutant["find"])
        except OSError as error:
            faults.append(f"{name}: {mutant['file']}: {error.strerror}")
            continue
        if count != 1:
            faults.append(f"{name}: its text stands {count} times in {mutant['file']}, not once")
    faults += [f"{name}: {count} mutants have this name" for name, count in names.items() if count > 1]
    return mutants, data.get("suite", []), faults


def suites_of(mutant, suites):
    """(program, filter) in the order to be run: of the first pattern that fits the file."""
    for suite in suites:
        if any(fnmatch.fnmatchcase(mutant["file"], pattern) for pattern in suite["files"]):
            return [tuple(pair) for pair in suite["run"]]
    return []


def explained():
    """Survivors that SURVIVORS.md explains: its headings."""
    with open(os.path.join(HERE, "SURVIVORS.md"), encoding="utf-8") as file:
        return set(re.findall(r"^### (\S+)", file.read(), re.MULTILINE))


def measured():
    """Fate of each mutant in RESULTS.md, as its cell of the table has it."""
    try:
        with open(PAGE, encoding="utf-8") as file:
            return dict(re.findall(r"^\| `(\S+)` \|.*\| (.+) \|$", file.read(), re.MULTILINE))
    except FileNotFoundError:
        return {}


def stale_pages(mutants):
    names, rows = {m["name"] for m in mutants}, measured().keys()
    faults = [f"SURVIVORS.md explains {n}, which is no mutant" for n in sorted(explained() - names)]
    faults += [f"RESULTS.md has no {n}: ./bench mutate" for n in sorted(names - rows)]
    faults += [f"RESULTS.md has {n}, which is no mutant: ./bench mutate" for n in sorted(rows - names)]
    return faults


def prove(build, suites):
    """Without any fault all tests must pass: else a failing test would prove nothing."""
    for program, test_filter in sorted({pair for suite in suites for pair in suite}):
        if test := first_failure(build.program_path(program), test_filter, build.folder):
            raise Broken(f"{program} fails without any mutant: {test}")


def try_mutant(mutant, suites, workshop):
    with open(os.path.join(ROOT, mutant["file"]), encoding="utf-8") as file:
        text = file.read()
    workshop.load(mutant["file"], text.replace(mutant["find"], mutant["put"]))
    for program, test_filter in suites_of(mutant, suites):
        try:
            test = first_failure(workshop.program(program), test_filter, workshop.build.folder)
        except Refused:
            return Outcome(mutant, REFUSED, "")
        except subprocess.TimeoutExpired:
            return Outcome(mutant, TIMED_OUT, program)
        if test:
            return Outcome(mutant, KILLED, f"{program}: {test}")
    return Outcome(mutant, SURVIVED, "")


def try_all(mutants, suites, build, jobs):
    workshops = queue.SimpleQueue()
    made = [Workshop(build) for _ in range(jobs)]
    for workshop in made:
        workshops.put(workshop)

    def one(mutant):
        workshop = workshops.get()
        try:
            return try_mutant(mutant, suites, workshop)
        finally:
            workshops.put(workshop)

    outcomes = []
    try:
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            for outcome in pool.map(one, mutants):
                outcomes.append(outcome)
                by = f" by {outcome.by}" if outcome.by else ""
                print(f"[{len(outcomes)}/{len(mutants)}] {outcome.mutant['name']}: {outcome.fate}{by}", flush=True)
    finally:
        for workshop in made:
            workshop.close()
    return outcomes


def cell_of(outcome):
    if outcome.fate == KILLED:
        return outcome.by
    return f"**{outcome.fate}**{' ' + outcome.by if outcome.by else ''}"


def fate_in(cell):
    marked = re.match(r"\*\*(.+?)\*\*", cell)
    return marked.group(1) if marked else KILLED


def summary(cells):
    """Of what became of mutants, in words, and the share that was killed."""
    count = collections.Counter(map(fate_in, cells))
    tried = len(cells) - count[REFUSED]
    share = count[KILLED] / tried if tried else 0.0
    text = (f"{tried} mutants: {count[KILLED]} killed by a failing test ({100 * share:.1f} %), {count[TIMED_OUT]} made "
            f"the tests run for ever, {count[SURVIVED]} survived. The compiler refused {count[REFUSED]} more, which "
            "are not counted.")
    return text, share


def write_results(mutants, cells, made_with):
    lines = ["<!-- SPDX-License-Identifier: Apache-2.0 -->", "<!-- Written by ./bench mutate: do not edit. -->",
             "# Mutation of the judge", "", summary(list(cells.values()))[0], "", made_with, "",
             "The last column names the first test that failed.", ""]
    known = [m for m in mutants if m["name"] in cells]
    for folder in sorted({os.path.dirname(m["file"]) for m in known}):
        lines += [f"## {folder}", "", "| mutant | file | fault | fate |", "|---|---|---|---|"]
        lines += [f"| `{m['name']}` | {os.path.basename(m['file'])} | {m['what']} | {cells[m['name']]} |"
                  for m in known if os.path.dirname(m["file"]) == folder]
        lines.append("")
    stamp.write(PAGE, "\n".join(lines))


def judge(outcomes):
    """Everything that is not as it should be."""
    faults, reasons = [], explained()
    for o in outcomes:
        name, expected = o.mutant["name"], o.mutant.get("expect")
        if expected is not None:
            if o.fate != expected:
                faults.append(f"{name}: {o.fate}, but it should have been {expected}")
        elif o.fate == SURVIVED and name not in reasons:
            faults.append(f"{name}: survived, and SURVIVORS.md does not say why")
        elif o.fate == KILLED and name in reasons:
            faults.append(f"{name}: killed, but SURVIVORS.md has it")
    return faults


class Parser(argparse.ArgumentParser):
    def error(self, message):
        self.print_usage(sys.stderr)
        self.exit(64, f"mutate: {message}\n")


def main():
    parser = Parser(prog="bench mutate", description=__doc__, formatter_class=RAW)
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="FOLDER",
                        help="build folder with the tests built")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these mutants; shell patterns are understood")
    parser.add_argument("--list", default=os.path.join(HERE, "mutants.toml"), metavar="FILE",
                        help="other mutants, each of which may say what must become of it")
    parser.add_argument("--check", action="store_true", help="does the list fit the sources? runs no test")
    parser.add_argument("--jobs", type=int, default=2, help="mutants at once")
    options = parser.parse_args()
    if options.jobs < 1:
        parser.error("--jobs must be at least 1")

    main_list = os.path.samefile(options.list, os.path.join(HERE, "mutants.toml"))
    mutants, suites, faults = read_list(options.list)
    if options.check and main_list:
        faults += stale_pages(mutants)
    if faults:
        print_faults(faults)
        return 65
    if options.check:
        print(f"{len(mutants)} mutants fit the sources")
        return 0
    chosen = [m for m in mutants if not options.only or any(fnmatch.fnmatchcase(m["name"], p) for p in options.only)]
    if not chosen:
        parser.error("no mutant has such a name")

    made_with = stamp.line_of("mutate", "no seed")
    build = Build(ROOT, os.path.abspath(options.build))
    prove(build, [suites_of(m, suites) for m in chosen])
    outcomes = try_all(chosen, suites, build, options.jobs)
    faults = judge(outcomes)
    cells = {o.mutant["name"]: cell_of(o) for o in outcomes}
    if main_list:
        names = {m["name"] for m in mutants}
        kept = {name: cell for name, cell in measured().items() if name in names and name not in cells}
        cells = kept | cells
        write_results(mutants, cells, stamp.line_with_rows_kept(made_with, PAGE) if kept else made_with)
    text, share = summary(list(cells.values()))
    print(text)
    if main_list and share < LEAST_SHARE:
        faults.append(f"less than {100 * LEAST_SHARE:.0f} % are killed")
    print_faults(faults)
    return 1 if faults else 0


def print_faults(faults):
    for fault in faults:
        print(f"mutate: {fault}", file=sys.stderr)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except tomllib.TOMLDecodeError as error:
        print(f"mutate: {error}", file=sys.stderr)
        sys.exit(65)
    except (Broken, OSError) as error:
        print(f"mutate: {error}", file=sys.stderr)
        sys.exit(2)
