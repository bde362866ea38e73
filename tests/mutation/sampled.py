#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mutation of the judge by a tool's rule: draws places of hil/inspect and of the kerf measurement evenly, puts a fault into
each, and sees whether the tests notice.

places.py has the rule. The list of places is cut into as many equal stretches as mutants are asked for, and one place of
each stretch is drawn: the same seed and the same sources give the same mutants. Other sources give others, nearly all of
them; --again tries those that RESULTS_SAMPLED.md has, as far as their places are still there, so that a sample is finished
whose tests, or whose faults of the bench, changed what it was drawn from. RESULTS_SAMPLED.md is written anew after each
mutant; with --only or --missing the rows of the mutants that were tried, and its figures stay as old as the rows that are
kept.
--asserting compiles the mutant with the assertions of the standard library and of Eigen, as the tests under sanitizers have
them: for mutants that read beyond an end.
A mutant that computes the same as the original can be killed by no test, and is left out of the score (Jia and Harman 2011,
"An Analysis and Survey of the Development of Mutation Testing"): those whose proof is in the first part of
SURVIVORS_SAMPLED.md. The score over all is printed beside it.
Ends with 0 if at least 90 % of those that are not the same by proof are killed by a failing test and each survivor is
explained in SURVIVORS_SAMPLED.md, 1 if not, 2 if nothing could be measured, 64 for a wrong command line.
"""
import collections
import concurrent.futures
import fnmatch
import glob
import itertools
import json
import os
import queue
import random
import re
import subprocess
import sys
import tomllib

import mutate
import places
from workshop import Broken, Build, Refused, Workshop, first_failure, run

PAGE = os.path.join(mutate.HERE, "RESULTS_SAMPLED.md")
HAND_PICKED = mutate.PAGE
REASONS = os.path.join(mutate.HERE, "SURVIVORS_SAMPLED.md")
PROVEN = "The same by proof"  # The part of that page whose mutants no test can kill.
QUICK_MS = 300  # Tests below it run first, in one process.
GROUP_MS = 15000  # Slower tests run in processes of about so long, the shortest first.
LIKELY_MS = 2500  # Tests that have killed a mutant of the same file go before all others, unless they are dearer.
CHEAP_MS = 16000  # What the tests of so long in all let live must wait for the rest until all others are done.
LIKELY, CHEAP, DEAR = range(3)
CUT_SHORT = "the cheap tests; the dear ones were not run"

Mutant = collections.namedtuple("Mutant", "name file offset text put line")
Outcome = collections.namedtuple("Outcome", "fate by")


class Kept:
    """What is dear to find out, kept in the build folder under a stamp of all that it depends on."""

    def __init__(self, build, name):
        self.path = os.path.join(build.folder, f"mutation_{name}.json")
        try:
            with open(self.path, encoding="utf-8") as file:
                self.values = json.load(file)
        except (OSError, ValueError):
            self.values = {}

    def value(self, key, stamp, find):
        if self.values.get(key, {}).get("stamp") != stamp:
            self.values[key] = {"stamp": stamp, "value": find()}
            with open(self.path, "w", encoding="utf-8") as file:
                json.dump(self.values, file)
        return self.values[key]["value"]


def stamp_of(*paths):
    """Changes when one of these files is written, as an object is when a header of its source changes."""
    return [[os.stat(path).st_mtime_ns, os.stat(path).st_size] for path in paths]


def arguments_of(words):
    """What the parser must know of how a source is compiled."""
    kept = []
    for word, following in zip(words, words[1:] + [""]):
        if word == "-isystem":
            kept += [word, following]
        elif word.startswith(("-D", "-I", "-std=")):
            kept.append(word)
    return kept


def all_places(build, folders):
    found, kept = [], Kept(build, "places")
    for path in places.sources(build.root, folders):
        source, item = os.path.join(build.root, path), build.objects_with(path)[0]
        stamp = stamp_of(source, os.path.join(build.folder, item), places.__file__)
        arguments = arguments_of(build.compile_of[item][1])
        found += [places.Place(*place) for place in
                  kept.value(path, stamp, lambda s=source, p=path, a=arguments: places.find(s, p, a))]
    return found


def below(rng, count):
    """A whole number below count; random() is the one method that Python promises to keep the same in all versions."""
    return int(rng.random() * count)


def sample(found, count, seed):
    """One place of each of `count` equal stretches, with one of its faults, in the order in which they are tried."""
    rng = random.Random(seed)
    chosen = []
    for i in range(count):
        first, behind = i * len(found) // count, (i + 1) * len(found) // count
        place = found[first + below(rng, behind - first)]
        put = place.puts[below(rng, len(place.puts))]
        name = f"{place.name_of}.{places.WORDS.get(put, put)}"
        chosen.append(Mutant(name, place.file, place.offset, place.text, put, place.line))
    for i in range(len(chosen) - 1, 0, -1):  # A run that is cut short has tried an even sample as well.
        j = below(rng, i + 1)
        chosen[i], chosen[j] = chosen[j], chosen[i]
    if len({m.name for m in chosen}) != len(chosen):
        raise Broken("two mutants have one name")
    return chosen


def named(found, names):
    """Mutants of these names, as they are found now."""
    known = {f"{place.name_of}.{places.WORDS.get(put, put)}": (place, put) for place in found for put in place.puts}
    return [Mutant(name, known[name][0].file, known[name][0].offset, known[name][0].text, known[name][1],
                   known[name][0].line) for name in names if name in known]


def changed_text(root, mutant):
    with open(os.path.join(root, mutant.file), "rb") as file:
        content = file.read()
    old = mutant.text.encode()
    if content[mutant.offset:mutant.offset + len(old)] != old:
        raise Broken(f"{mutant.file} changed meanwhile")
    return (content[:mutant.offset] + mutant.put.encode() + content[mutant.offset + len(old):]).decode()


def durations_ms(build, workshop, program, test_filter, sources):
    """How long each test takes without a fault, all of which must pass: else a failing test would prove nothing."""
    print(f"{program} without a fault ...", flush=True)
    path = workshop.program_apart(program, sources)
    result = run([path, f"--gtest_filter={test_filter}", "--gtest_color=no"], build.folder)
    os.remove(path)
    passed = re.findall(r"^\[       OK \] (\S+) \((\d+) ms\)$", result.stdout, re.MULTILINE)
    if result.returncode != 0 or not passed:
        raise Broken(f"{program} fails without any mutant:\n{result.stdout[-2000:]}")
    return {name: int(ms) for name, ms in passed}


def groups_of(timed):
    """(program, tests, milliseconds) from cheap to dear, of (milliseconds, program, test)."""
    groups = []
    for program in dict.fromkeys(program for _, program, _ in timed):
        quick = [(ms, test) for ms, p, test in timed if p == program and ms < QUICK_MS]
        if quick:
            groups.append((program, [test for _, test in quick], sum(ms for ms, _ in quick)))
    tests, spent, current = [], 0, None
    for ms, program, test in sorted(t for t in timed if t[0] >= QUICK_MS) + [(0, None, None)]:
        if tests and (program != current or spent + ms > GROUP_MS):
            groups.append((current, tests, spent))
            tests, spent = [], 0
        current, tests, spent = program, tests + [test], spent + ms
    return groups


def known_killers(*pages):
    """Tests that have killed a mutant of a file before, by the name of the file: most likely they kill the next one."""
    killers = collections.defaultdict(set)
    for page in pages:
        try:
            with open(page, encoding="utf-8") as file:
                text = file.read()
        except FileNotFoundError:
            continue
        row = r"^\| `\S+` \| ([\w.]+?)(?::\d+)? \|.*\| (\w+): (\S+)[^|]* \|$"
        for name, program, test in re.findall(row, text, re.MULTILINE):
            killers[name].add((program, test.removesuffix(",")))
    return killers


def suite_of(test):
    """Name of a test's suite, without the prefix and the parameter of a suite that has some."""
    return test.split(".")[0].split("/")[-1]


def tests_named_after(path):
    """Suites in those test sources whose name begins as the source's does, or the other way round."""
    stem, suites = os.path.splitext(os.path.basename(path))[0], set()
    for source in glob.glob(os.path.join(mutate.ROOT, "tests", "hil", path.split("/")[1], "*_test.cpp")):
        tested = os.path.basename(source).removesuffix("_test.cpp")
        if tested.startswith(stem) or stem.startswith(tested):
            with open(source, encoding="utf-8") as file:
                suites |= set(re.findall(r"^TEST(?:_F|_P)?\((\w+),", file.read(), re.MULTILINE))
    return suites


class Bench:
    """Tries mutants, as many at a time as there are workshops."""

    def __init__(self, build, suites, mutants, first, asserting, jobs):
        self.build = build
        self.first = first
        workshop = Workshop(build, apart=True, asserting=asserting)
        proof, self.groups, self.ms = Kept(build, "proof"), {}, {}
        sources = {}
        for mutant in mutants:
            sources.setdefault(tuple(mutate.suites_of({"file": mutant.file}, suites)), set()).add(mutant.file)
        for suite, files in sources.items():
            timed = []
            for program, test_filter in suite:
                durations = proof.value(
                    f"{program} {test_filter}", stamp_of(build.program_path(program)),
                    lambda p=program, t=test_filter, f=sorted(files): durations_ms(build, workshop, p, t, f))
                timed += [(ms, program, test) for test, ms in durations.items()]
            self.ms |= {(program, test): ms for ms, program, test in timed}
            self.groups[suite] = groups_of(timed)
        self.suites = suites
        self.workshops = [workshop] + [
            Workshop(build, apart=True, asserting=asserting, beside=workshop) for _ in range(jobs - 1)]
        self.free = queue.SimpleQueue()
        for workshop in self.workshops:
            self.free.put(workshop)
        self.killers = {}

    def close(self):
        for workshop in self.workshops:
            workshop.close()

    def groups_for(self, mutant, stage):
        """Groups of tests of a stage: those that most likely see the mutant, the cheap ones, the dear ones."""
        groups = self.groups[tuple(mutate.suites_of({"file": mutant.file}, self.suites))]
        if stage == LIKELY:
            return self.likely_for(mutant, groups)
        spent = itertools.accumulate(ms for _, _, ms in groups)
        return [group for group, ms in zip(groups, spent) if (ms > CHEAP_MS) == (stage == DEAR)]

    def likely_for(self, mutant, groups):
        """One group for each program: tests that have killed a mutant of the same file before, then those of its name."""
        killers = self.killers.get(os.path.basename(mutant.file), ())
        named = tests_named_after(mutant.file)
        stem = os.path.splitext(os.path.basename(mutant.file))[0]
        wanted = [pattern.split(":")[1] for pattern in self.first if pattern.split(":")[0] == stem]
        likely = []
        for program in dict.fromkeys(program for program, _, _ in groups):
            all_of_it = sorted((ms, test) for (p, test), ms in self.ms.items() if p == program)
            first = [(ms, t) for ms, t in all_of_it if any(fnmatch.fnmatchcase(t, pattern) for pattern in wanted)]
            if first:
                likely.append((program, [t for _, t in first], sum(ms for ms, _ in first)))
            mine = [(ms, t) for ms, t in all_of_it if ms < LIKELY_MS and (ms, t) not in first]
            tests = [(ms, t) for ms, t in mine if (program, t) in killers]
            tests += [(ms, t) for ms, t in mine if suite_of(t) in named and (ms, t) not in tests]
            spent = list(itertools.accumulate(ms for ms, _ in tests))
            tests = [t for (_, t), ms in zip(tests, spent) if ms < 2 * LIKELY_MS]
            if tests:
                likely.append((program, tests, sum(self.ms[program, t] for t in tests)))
        return likely

    def try_one(self, mutant, stage):
        workshop = self.free.get()
        try:
            return self.try_in(workshop, mutant, stage)
        finally:
            self.free.put(workshop)

    def try_in(self, workshop, mutant, stage):
        workshop.load(mutant.file, changed_text(self.build.root, mutant))
        for program, tests, ms in self.groups_for(mutant, stage):
            try:
                test = first_failure(workshop.program(program), ":".join(tests), self.build.folder, 30 + ms / 200)
            except Refused:
                return Outcome(mutate.REFUSED, "")
            except subprocess.TimeoutExpired:
                return Outcome(mutate.TIMED_OUT, program)
            if test:
                return Outcome(mutate.KILLED, f"{program}: {test}{', with assertions' if workshop.asserting else ''}")
        return Outcome(mutate.SURVIVED, "")

    def try_all(self, mutants, keep):
        """Tells `keep` the fate of each mutant. What the tests of one stage let live waits until all have passed it."""
        for stage in (LIKELY, CHEAP, DEAR):
            self.killers = known_killers(HAND_PICKED, PAGE)  # Once, so that the number of jobs changes nothing.
            with concurrent.futures.ThreadPoolExecutor(len(self.workshops)) as pool:
                mutants = self.keep_all(mutants, stage, pool.map(lambda m, s=stage: self.try_one(m, s), mutants), keep)

    @staticmethod
    def keep_all(mutants, stage, outcomes, keep):
        """Those that are still to be killed."""
        alive = []
        for number, (mutant, outcome) in enumerate(zip(mutants, outcomes), 1):
            is_open = outcome.fate == mutate.SURVIVED and stage != DEAR
            print(f"[{number}/{len(mutants)}] {mutant.file}:{mutant.line} {mutant.name}: "
                  f"{'not yet killed' if is_open else outcome.fate} {outcome.by}", flush=True)
            if is_open:
                alive.append(mutant)
            if stage == CHEAP and is_open:
                keep(mutant, Outcome(mutate.SURVIVED, CUT_SHORT))  # Until the dear ones have said otherwise.
            elif not is_open:
                keep(mutant, outcome)
        return alive


def fault_of(mutant):
    def quoted(text):
        return f"`{text}`".replace("|", "\\|")
    return f"{quoted(mutant.text)} → {quoted(mutant.put)}" if mutant.put else f"{quoted(mutant.text)} left out"


def write_page(mutants, cells, found, folders, drawn, made_with):
    known = [m for m in mutants if m.name in cells]
    kinds = collections.Counter("comparisons" if p.text in places.COMPARISONS else "signs" if p.text in places.SIGNS else
                                "connectives" if p.text in places.CONNECTIVES else "constants" for p in found)
    own = {m.name: cells[m.name] for m in known}
    explained = sum(mutate.fate_in(cells[m.name]) == mutate.SURVIVED and m.name in reasons() for m in known)
    lines = [
        "<!-- SPDX-License-Identifier: Apache-2.0 -->", "<!-- Written by ./bench mutate --sample: do not edit. -->",
        "# Mutation of the judge by rule", "",
        f"The rule of `places.py` finds {len(found)} places in {', '.join(folders)}: "
        f"{', '.join(f'{n} {kind}' for kind, n in kinds.most_common())}. Of them, {len(mutants)} were drawn evenly with "
        f"{drawn}; {len(known)} have been tried.",
        "", mutate.summary(list(own.values()))[0] +
        f" SURVIVORS_SAMPLED.md explains {explained} of those that survived.", "", score(own)[0], "", made_with, "",
        "The last column names the first test that failed; tests run from cheap to dear.", ""]
    for folder in sorted({os.path.dirname(m.file) for m in known}):
        lines += [f"## {folder}", "", "| mutant | place | fault | fate |", "|---|---|---|---|"]
        lines += [f"| `{m.name}` | {os.path.basename(m.file)}:{m.line} | {fault_of(m)} | {cells[m.name]} |"
                  for m in sorted(known, key=lambda m: (m.file, m.offset)) if os.path.dirname(m.file) == folder]
        lines.append("")
    mutate.stamp.write(PAGE, "\n".join(lines))


def rows():
    """Fate of each mutant in RESULTS_SAMPLED.md."""
    try:
        with open(PAGE, encoding="utf-8") as file:
            return dict(re.findall(r"^\| `(\S+)` \|.*\| (.+) \|$", file.read(), re.MULTILINE))
    except FileNotFoundError:
        return {}


def reasons(part=None):
    """Survivors that SURVIVORS_SAMPLED.md explains: all of them, or those of one part."""
    try:
        with open(REASONS, encoding="utf-8") as file:
            text = file.read()
    except FileNotFoundError:
        return set()
    parts = re.split(r"^## (.+)$", text, flags=re.MULTILINE)
    chosen = [body for title, body in zip(parts[1::2], parts[2::2]) if part in (None, title)]
    return set(re.findall(r"^### (\S+)", "".join(chosen), re.MULTILINE))


def score(cells):
    """What was killed of the mutants that are not the same by proof, in words and as a share."""
    same = {name for name, cell in cells.items()
            if mutate.fate_in(cell) == mutate.SURVIVED and name in reasons(PROVEN)}
    share = mutate.summary([cell for name, cell in cells.items() if name not in same])[1]
    return (f"Of them, {len(same)} are the same as the original by proof, so that no test can kill them. Of the others "
            f"{100 * share:.1f} % are killed."), share


def judge(cells):
    """Everything of the page that is not as it should be."""
    fates = {name: mutate.fate_in(cell) for name, cell in cells.items()}
    faults = [f"{name}: survived, and SURVIVORS_SAMPLED.md does not say why"
              for name, fate in fates.items() if fate == mutate.SURVIVED and name not in reasons()]
    faults += [f"{name}: {fates.get(name, 'no mutant')}, but SURVIVORS_SAMPLED.md has it"
               for name in sorted(reasons()) if fates.get(name) != mutate.SURVIVED]
    if score(cells)[1] < mutate.LEAST_SHARE:
        faults.append(f"less than {100 * mutate.LEAST_SHARE:.0f} % of those that are not the same by proof are killed")
    return faults


def parsed():
    parser = mutate.Parser(prog="bench mutate", description=__doc__, formatter_class=mutate.RAW)
    parser.add_argument("--build", default=os.path.join(mutate.ROOT, "build", "release"), metavar="FOLDER",
                        help="build folder with the tests built")
    parser.add_argument("--sample", type=int, required=True, metavar="N", help="mutants to draw")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="the mutants of RESULTS_SAMPLED.md instead of a new draw")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these mutants; shell patterns are understood")
    parser.add_argument("--missing", action="store_true", help="only those that RESULTS_SAMPLED.md has no row of")
    parser.add_argument("--first", nargs="+", default=[], metavar="FILE:TEST",
                        help="tests to run first on mutants of FILE, named without folder and .cpp; patterns too")
    parser.add_argument("--asserting", action="store_true", help="with the assertions of libraries, as with sanitizers")
    parser.add_argument("-j", "--jobs", type=int, default=os.cpu_count() or 1, metavar="N",
                        help="mutants at a time (as many as there are cores); the results are the same at any number")
    parser.add_argument("--dry-run", action="store_true", help="prints the mutants, and tries none")
    options = parser.parse_args()
    if any(":" not in first for first in options.first):
        parser.error("--first takes FILE:TEST")
    if options.sample < 1:
        parser.error("--sample must be at least 1")
    if options.jobs < 1:
        parser.error("--jobs must be at least 1")
    return parser, options


def main():
    parser, options = parsed()
    with open(os.path.join(mutate.HERE, "sampled.toml"), "rb") as file:
        rule = tomllib.load(file)
    build = Build(mutate.ROOT, os.path.abspath(options.build))
    found = all_places(build, rule["folders"])
    if options.sample > len(found):
        parser.error(f"there are only {len(found)} places")
    mutants = named(found, rows()) if options.again else sample(found, options.sample, options.seed)
    if options.dry_run:
        for m in mutants:
            print(f"{m.file}:{m.line}: {m.name}")
        return 0
    names = {m.name for m in mutants}
    cells = {name: cell for name, cell in rows().items() if name in names}
    chosen = [m for m in mutants if not options.only or any(fnmatch.fnmatchcase(m.name, p) for p in options.only)]
    chosen = [m for m in chosen if not options.missing or m.name not in cells]

    drawn = f"seed {options.seed}{' from an earlier state of the sources' if options.again else ''}"
    made_with = mutate.stamp.line_of(
        "sampled", f"seed {options.seed}",
        f"./bench mutate --sample {options.sample} --seed {options.seed}{' --again' if options.again else ''}")
    of_before = mutate.stamp.line_with_rows_kept(made_with, PAGE)
    kept = set(cells)  # Rows of an earlier run.

    def keep(mutant, outcome):
        cells[mutant.name] = mutate.cell_of(outcome)
        kept.discard(mutant.name)
        write_page(mutants, cells, found, rule["folders"], drawn, of_before if kept else made_with)

    bench = Bench(build, rule["suite"], chosen, options.first, options.asserting, options.jobs)
    try:
        bench.try_all(chosen, keep)
    finally:
        bench.close()
    write_page(mutants, cells, found, rule["folders"], drawn, of_before if kept else made_with)
    print(mutate.summary(list(cells.values()))[0])
    print(score(cells)[0])
    faults = judge(cells)
    mutate.print_faults(faults)
    return 1 if faults else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (Broken, OSError, places.Unparsed) as error:
        print(f"mutate: {error}", file=sys.stderr)
        sys.exit(2)
