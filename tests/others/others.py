#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads drawings by other people's programs with both readers, and writes the table of docs/explanation/drawings-of-others.md.

The drawings are not in this repository. tests/others/others.toml names public repositories with a commit each: clone them
into one folder and give that folder. Every drawing goes through `kerfbench lint --witness` as a user would type it, with all
lines as one process, and ends in one of these classes:

  agree    both readers find the same lengths and boxes, to 1 um
  empty    neither finds a line
  refused  this reader refuses the drawing, with a sentence
  no second reading  the second reader cannot read it, or does not follow something in it
  part     they read different things
  broken   a reader crashed, hung or answered what is no answer

With --cut three cartons that these programs draw (tests/others/cartons.toml) are cut and judged instead, and then their spoiled
jobs. That takes esbuild, node, python3-qrcode, python3-affine, python3-markdown and python3-shapely, which `bench` does not install.

With --reasons a file gets the sentences behind all drawings that do not agree, for people to look into: who is right?
Exit code: 0 done, 1 a reader broke or a verdict is wrong, 2 a repository is not there, 64 usage.
"""
import argparse
import collections
import concurrent.futures
import os
import re
import subprocess
import sys
import tempfile
import tomllib

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "tests", "figures"))
import cartons  # noqa: E402
import stamp  # noqa: E402
import unpacking  # noqa: E402

PAGE = "docs/explanation/drawings-of-others.md"
LIST = "tests/others/others.toml"
CLASSES = ("agree", "empty", "refused", "no second reading", "part", "broken")
BEGIN, CUT_BEGIN = "<!-- ./bench drawings writes from here -->", "<!-- ./bench drawings --cut writes from here -->"
END = "<!-- to here -->"
LONGEST_S = 600

Reading = collections.namedtuple("Reading", "kind why")


def read_list(path):
    with open(path, "rb") as opened:
        return tomllib.load(opened)["repository"]


def patterns(repository):
    """The paths of its drawings, as git has them."""
    wanted = [f":(icase,glob){below}**/*.{repository['kind']}" for below in repository.get("below", [""])]
    return wanted + [f":(exclude){name}" for name in repository.get("but", [])]


def reading_of(code, said, errors):
    """What a drawing's reading came to, from what lint printed and its exit code."""
    witness = [line for line in said.splitlines() if ": the second reader (" in line or "the second reader cannot" in line]
    for line in witness:
        if " agrees on " in line:
            return Reading("empty" if ", 0.000 mm in all" in line else "agree", "")
        if " parts from this one in " in line:
            apart = [other.split(": error: ", 1)[1] for other in said.splitlines() if ": error: " in other]
            return Reading("part", "; ".join(apart[:3]))
        if "cannot read the drawing" in line:
            return Reading("no second reading", line.split(": error: ", 1)[1])
    if code == 65 and errors:
        return Reading("refused", errors.splitlines()[0])
    return Reading("broken", f"exit code {code}: {(errors or said).strip()[-300:]}")


def read_one(program, folder, name):
    unit = ["--unit", "mm"] if name.lower().endswith(".dxf") else []
    try:
        done = subprocess.run([program, "lint", "--witness", "--layer", "*/other=cut", *unit, name], cwd=folder,
                              capture_output=True, text=True, errors="replace", timeout=LONGEST_S, check=False)
    except subprocess.TimeoutExpired:
        return Reading("broken", f"more than {LONGEST_S} s")
    return reading_of(done.returncode, done.stdout, done.stderr.replace(name, "FILE"))


def tell(text):
    if sys.stderr.isatty():
        sys.stderr.write("\r" + text.ljust(70))
        sys.stderr.flush()


def row_of(repository, counts):
    below = ", ".join(repository.get("below", []))
    where = "/".join(repository["url"].split("/")[-2:])
    return (f"| {where} {repository['commit'][:8]}{': ' + below if below else ''} ({repository['kind'].upper()}) | "
            f"{sum(counts.values())} | " + " | ".join(str(counts[kind]) for kind in CLASSES) + " |")


def put_into(page, begin, lines):
    """The page with these lines between its marks."""
    before, found, rest = page.partition(begin)
    _, end, after = rest.partition(END)
    if not found or not end:
        raise unpacking.Missing(f"{PAGE} lacks its marks {begin} and {END}")
    return before + begin + "\n" + "\n".join(lines) + "\n" + END + after


def write_table(begin, lines, is_whole):
    """Prints a table, and puts it into the page if it is whole."""
    tell("")
    print("\n".join(lines))
    if is_whole:
        page = os.path.join(ROOT, PAGE)
        stamp.write(page, put_into(stamp.read(page), begin, lines))


def read_all(options, repositories, reasons):
    """The rows of the table. What does not agree goes to `reasons`."""
    rows, sums = [], collections.Counter()
    for repository in repositories:
        with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            names = unpacking.unpack(options.folder, repository["folder"], repository["commit"], patterns(repository), folder)
            names = names[::options.every]
            readings = []
            for reading in pool.map(lambda name, at=folder: read_one(options.program, at, name), names):
                readings.append(reading)
                tell(f"{repository['folder']} {repository['kind']}: {len(readings)} of {len(names)}")
        counts = collections.Counter(reading.kind for reading in readings)
        sums += counts
        rows.append(row_of(repository, counts))
        reasons += [f"{repository['folder']}/{name}: {reading.kind}: {reading.why}"
                    for name, reading in zip(names, readings, strict=True) if reading.kind not in ("agree", "empty")]
    rows.append(f"| all | {sum(sums.values())} | " + " | ".join(str(sums[kind]) for kind in CLASSES) + " |")
    return rows, sums


def read_drawings(options):
    line = stamp.line_of("drawings", "no seed")
    repositories = [one for one in read_list(os.path.join(ROOT, LIST)) if not options.only or one["folder"] in options.only]
    reasons = []
    rows, sums = read_all(options, repositories, reasons)
    table = [line, "", "| public repository, commit | drawings | " + " | ".join(CLASSES) + " |",
             "|" + "---|" * (len(CLASSES) + 2), *rows]
    write_table(BEGIN, table, not options.only and options.every == 1)
    if options.reasons:
        stamp.write(options.reasons, "\n".join(reasons) + "\n")
    return 1 if sums["broken"] else 0


def cut_all(options):
    line = stamp.line_of("cartons", "seed 1")
    rows, wrong = cartons.table(ROOT, options.folder, options.program, options.jobs)
    pieces, others_wrong = cartons.table_of_pieces(ROOT, options.program, options.jobs)
    wrong += others_wrong
    write_table(CUT_BEGIN, [line, "", *rows, "", "And an ellipse of 60 x 40 mm, drawn as straight pieces, on the two mirrors:", "",
                            *pieces], is_whole=not wrong)
    for sentence in wrong:
        print(f"drawings: not as it should be: {sentence}", file=sys.stderr)
    return 1 if wrong else 0


def main():
    parser = argparse.ArgumentParser(prog="bench drawings", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="where the clones of the repositories of " + LIST + " lie")
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), help="the build that is tried")
    parser.add_argument("--cut", action="store_true", help="cut three cartons instead: the second table of the page")
    parser.add_argument("--only", metavar="NAME", action="append", default=[], help="only these repositories; writes no page")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="only each Nth drawing; writes no page")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="drawings at a time")
    parser.add_argument("--reasons", metavar="FILE", help="write why drawings do not agree")
    try:
        options = parser.parse_args()
        if options.every < 1 or options.jobs < 1:
            parser.error("--every and --jobs are 1 or more")
    except SystemExit as end:
        return 64 if end.code else 0
    options.program = os.path.join(os.path.abspath(options.build), "bin", "kerfbench")
    return cut_all(options) if options.cut else read_drawings(options)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (unpacking.Missing, OSError) as error:
        print(f"drawings: {error}", file=sys.stderr)
        sys.exit(2)
