#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes hostile files of every kind that the bench reads, and gives each to the command that reads it, within limits: what is
the exit code, how much time and memory does it take, what is said? Writes RESULTS.md.

Exit code: 0 nothing is wrong but what OPEN gives a reason for, 1 something is (each is named), 2 something broke, 64 usage."""
import argparse
import collections
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import bounded
import cases
import children
import configurations
import drawings
import evidence
import readers

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
# What is taken wrongly, and why it was left so.
OPEN = {
    "edited/unknown keys, 20 000": "The keys of a scenario are kept in the order of the file, and each new one is compared with all before it: 20 000 "
                                   "keys take 0.7 s, 40 000 take 3.8 s. A text is at most 1 MiB, and it is the user's own.",
}
# What the sources no longer do, but the programs that the page was measured with. To be emptied when the page is measured anew.
MENDED = {
    "*/symlink loop": "A loop of links is refused as the user's (65).",
    "edited/*": "The message names the file.",
    "gcode/*": "The message names the file, and a line of millions of words costs no sentence for each.",
    "*/1 GB, sparse": "A recording of any size is gone through in pieces, and the sum of any file is taken (decision 088): the time is allowed.",
    "*/sound, then zeros to 1 GB": "As before.",
    "svg/use of what has 10^5 attributes": "An element of more than 1000 attributes is refused.",
    "xyz/foreign file": "No word of a file that does not begin as a contour is shown.",
    "vcd/foreign file": "No word of a file that does not begin as a recording is shown.",
}
YAML_READERS = ("scenario", "machine", "fold", "suite", "campaign", "material", "edited")

# What decides the page of figures.
SOURCES = "hil/base hil/calibrate/tables hil/cli hil/dieline hil/source hil/trace tests/hostile"


def all_cases(bench):
    made = []
    for reader in readers.READERS:
        made += cases.common(reader.name, bench.sound / reader.sound, reader.is_text, reader.any_size)
        if reader.name in YAML_READERS:
            made += configurations.yaml_cases(reader.name, (bench.sound / reader.sound).read_text())
    made += drawings.dxf_cases() + drawings.svg_cases() + drawings.other_cases()
    made += configurations.scenario_cases() + configurations.plan_cases()
    made += evidence.vcd_cases() + evidence.trace_cases() + evidence.table_cases() + evidence.picture_cases() + evidence.image_cases()
    return made + children.child_cases()


class Row:
    """A case that was tried: what came of it."""

    def __init__(self, case, ended, cpu_s, memory_mib, first, wrong, command=""):
        self.case, self.ended, self.cpu_s, self.memory_mib = case, ended, cpu_s, memory_mib
        self.first, self.wrong, self.command = first, wrong, command

    def line(self):
        words = f"{self.case.name()}: {self.ended}, {self.cpu_s:.2f} s, {self.memory_mib} MiB"
        return words + "".join(f"\n    {fault}" for fault in self.wrong) + (
            f"\n    {self.command}\n    {self.first}" if self.wrong else "")

    def cells(self):
        return f"| {self.case.name()} | {self.ended} | {self.cpu_s:.2f} | {self.memory_mib} | {self.first} | {'; '.join(self.wrong)} |"


def rows_of(page, cases_by_name):
    """The rows of a page that was written before, by the names of their cases."""
    rows = {}
    for line in page.read_text().splitlines():
        cells = [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]
        if len(cells) == 6 and cells[0] in cases_by_name:
            name, ended, cpu_s, memory, first, wrong = cells
            rows[name] = Row(cases_by_name[name], ended, float(cpu_s), int(memory), first, [part for part in wrong.split("; ") if part])
    return rows


def try_one(case, bench, seed, top, sound):
    """Makes the file, gives it to its reader, removes it."""
    reader = next(r for r in readers.READERS if r.name == case.reader)
    place = pathlib.Path(tempfile.mkdtemp(prefix="case-", dir=top))
    try:
        file = cases.path_in(place, case, reader.suffix)
        case.make(file, cases.draw_for(case, seed))
        case.named.append(reader.sound if reader.where else file.name)
        if reader.where:
            case.named.append(reader.where)
        case.codes = tuple(case.codes) + tuple(reader.codes)
        command = bench.command(reader, file, place, case.extra)
        outcome = bench.runner.run(command, str(place))
        told = " ".join([os.path.basename(command[0]), *command[1:]]).replace(str(place), "OUT").replace(str(bench.sound), "SOUND")
        outcome.words = outcome.words.replace(str(place), "OUT")
        return Row(case, outcome.ended(), outcome.cpu_s, outcome.memory >> 20, kept_short(outcome.first_line()),
                   bounded.faults(case, outcome, sound[reader.name]), bounded.shown(told).replace("OUT/OUT", "OUT"))
    finally:
        shutil.rmtree(place, ignore_errors=True)


def kept_short(text, most=110):
    text = bounded.shown(text).replace("|", "\\|").replace("`", "'")
    return text if len(text) <= most else text[:most] + "…"


def sums(rows):
    """A line for each kind of file, and one for each reader."""
    lines = []
    for title, key in (("kind", lambda row: row.case.group), ("reader", lambda row: row.case.reader)):
        lines += [f"| {title} | files | exit codes | most CPU, s | most memory, MiB | wrong |", "|---|---|---|---|---|---|"]
        groups = collections.defaultdict(list)
        for row in rows:
            groups[key(row)].append(row)
        for name, group in sorted(groups.items()):
            codes = collections.Counter(row.ended for row in group)
            lines.append(f"| {name} | {len(group)} | {', '.join(f'{code}: {n}' for code, n in sorted(codes.items()))} | "
                         f"{max(row.cpu_s for row in group):.1f} | {max(row.memory_mib for row in group)} | "
                         f"{sum(bool(row.wrong) for row in group)} |")
        lines.append("")
    return "\n".join(lines)


def still_open(rows):
    """What is taken wrongly, and why it was left so."""
    wrong = [row for row in rows if row.wrong]
    if not wrong:
        return ""
    return "## Open\n\n" + "\n".join(f"- {row.case.name()}: {'; '.join(row.wrong)}. {why_open(row)}" for row in wrong) + "\n"


def why_open(row):
    if row.case.name() in OPEN:
        return OPEN[row.case.name()]
    for pattern, mend in MENDED.items():
        if fnmatch.fnmatchcase(row.case.name(), pattern):
            return f"Mended since in the sources: {mend}"
    if row.ended == "hang":
        return (f"The computer was loaded: the command had had {row.cpu_s:.1f} s of processor when the time on the clock was over. How long it takes "
                "alone was not measured.")
    return "Not looked at yet."


def page(rows, sound, seed):
    sys.path.insert(0, str(ROOT / "tests/figures"))
    import stamp
    # In stamp.PAGES from the first page on: its test asks for the page.
    stamp.PAGES.setdefault("hostile", stamp.Page("tests/hostile/RESULTS.md", "./bench hostile", SOURCES))
    made_with = stamp.line_of("hostile", f"seed {seed}")
    table = "\n".join(row.cells() for row in rows)
    commands = "\n".join(f"| {reader.name} | `{reader.command}` | {sound[reader.name].cpu_s:.2f} | {sound[reader.name].memory >> 20} |"
                         for reader in readers.READERS)
    honest = "\n".join(f"- {row.case.name()}: {row.case.honest[0]:.0f} s, {row.case.honest[1] >> 20} MiB" for row in rows if row.case.honest)
    return f"""<!-- SPDX-License-Identifier: Apache-2.0 -->
# Hostile files

{made_with}

`./bench hostile` makes {len(rows)} files that are broken, or made to harm, and gives each to the command that reads such files.
Wrong is: an exit code other than {', '.join(map(str, bounded.CODES))} (75 where runs of a campaign are missing), an end by a signal, no end within
{bounded.STOP_CPU_S} s of processor or after {bounded.STOP_ASLEEP_S} s asleep, more than {bounded.MOST_CPU_S:.0f} s of processor beside what a sound file takes, more than {bounded.MOST_MEMORY >> 20} MiB of memory, a refusal that names no
file, control characters or lines that a CI server obeys in the output, more than {bounded.MOST_WORDS >> 10} KiB of words, and words of a file that is not
of the kind that was asked for. {sum(bool(row.wrong) for row in rows)} of {len(rows)} are wrong.

{still_open(rows)}
{sums(rows)}
Files that are sound and large may take more:

{honest}

## The commands

`FILE` is the hostile file, `SOUND` a folder with a sound file of each kind, `COPY` a copy of a sound folder in which one file is hostile, `OUT` an
empty folder. The figures are those of the sound file.

| reader | command | CPU, s | memory, MiB |
|---|---|---|---|
{commands}

## Each file

| file | exit code | CPU, s | memory, MiB | first line | wrong |
|---|---|---|---|---|---|
{table}
"""


def chosen(case, args):
    if args.quick and not case.quick:
        return False
    return not args.only or any(fnmatch.fnmatchcase(case.name(), name) for name in args.only)


def parse():
    parser = argparse.ArgumentParser(prog="bench hostile", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--only", nargs="+", metavar="NAME", help="only these, as reader/kind; * stands for any text. No page is written unless --again")
    parser.add_argument("--again", action="store_true", help="with --only: their rows of the page are measured again, the others are kept")
    parser.add_argument("--quick", action="store_true", help="some of each sort. No page is written")
    parser.add_argument("--list", action="store_true", help="only say which files there are")
    parser.add_argument("--seed", type=int, default=1, help="seed of what is drawn (1)")
    parser.add_argument("--page", type=pathlib.Path, default=HERE / "RESULTS.md", help="where the table is written")
    try:
        return parser.parse_args()
    except SystemExit as end:
        sys.exit(64 if end.code else 0)


def main():
    args = parse()
    runner = bounded.Runner()
    top = pathlib.Path(tempfile.mkdtemp(prefix="hostile-"))
    try:
        bench = readers.Bench(args.build, top, runner)
        bench.prepare()
        everything = all_cases(bench)
        wanted = [case for case in everything if chosen(case, args)]
        if args.list:
            print("\n".join(case.name() for case in wanted))
            return 0
        if not wanted:
            print("bench hostile: no file is called so", file=sys.stderr)
            return 64
        kept = rows_of(args.page, {case.name(): case for case in everything}) if args.again else {}
        used = {case.reader for case in (everything if args.again else wanted)}
        sound = {}
        for reader in readers.READERS:
            if reader.name in used:
                sound[reader.name] = bench.costs(reader, tempfile.mkdtemp(prefix="sound-", dir=top))
                if sound[reader.name].code not in bounded.CODES[:4] + tuple(reader.codes):
                    raise RuntimeError(f"{reader.name}: its sound file ends with {sound[reader.name].ended()}: {sound[reader.name].words}")
        rows = []
        for case in wanted:
            rows.append(try_one(case, bench, args.seed, top, sound))
            if rows[-1].wrong or args.only:
                print(rows[-1].line(), flush=True)
        wrong = [row for row in rows if row.wrong]
        print(f"{len(rows)} hostile files, {len(wrong)} taken wrongly, {sum(row.case.name() in OPEN for row in wrong)} of them with a reason")
        if args.again:
            kept.update({row.case.name(): row for row in rows})
            rows = [kept[case.name()] for case in everything if case.name() in kept]
        if args.again or not (args.only or args.quick):
            args.page.write_text(page(rows, sound, args.seed))
        return 1 if any(row.case.name() not in OPEN for row in wrong) else 0
    except (OSError, RuntimeError) as error:
        print(f"bench hostile: {error}", file=sys.stderr)
        return 2
    finally:
        runner.stop()
        shutil.rmtree(top, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
