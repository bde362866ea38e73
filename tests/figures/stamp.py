#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Says on each page of figures whether they are older than their sources.

A line tells what figures were made with: commit and its date, seeds, command, and a digest of the sources that decide them:

    *Figures of commit 0123abcd of 2026-11-23, seed 1, by `command`; of sources `hil/vision hil/gauge`, 0123456789ab.*

Commands that write a page take their line from here. If the sources have changed since, the line has to end in "; older than
their sources.*". This program puts these words into all such lines of the tree, or takes them out. With --check it changes
nothing. Exit code: 0 all lines are right now, 1 with --check: one is not, 2 something broke, 64 usage.
"""
import argparse
import collections
import hashlib
import io
import os
import re
import subprocess
import sys
import tarfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
# Folders in which pages of figures may lie.
TOPS = ("docs", "fixtures", "firmware_under_test", "hil", "tests", "twin")
# figures_test.cpp reads the same lines and the same files.
STAMP = re.compile(r"\*Figures of commit (?P<commit>[0-9a-f]{7,40}) of \d{4}-\d\d-\d\d(?: and changes to it)?, "
                   r"(?:no seed|seeds? [^`]+), by `[^`]+`; of sources `(?P<sources>[^`]+)`, (?P<digest>[0-9a-f]{12})"
                   r"(?P<old>; older than their sources)?\.\*")
OLD = "; older than their sources"
SUFFIXES = (".c", ".cpp", ".h", ".py")

Page = collections.namedtuple("Page", "path command sources")

# The sources of a page are the rooms that measure and judge, and what the command itself brings: faults, edits, scenes,
# studies. Left out is what only carries the evidence there (planner, firmware, twin, cameras, scenarios), though it takes
# part in most of these runs: it has tests of its own, and with it a page would be older after nearly every commit, so that
# nobody would heed the words. The page about the twin has the twin instead. For mutants the tests count as well, because a
# new one may kill a survivor.
PAGES = {
    "validate": Page("twin/VALIDATION.md", "./bench validate", "twin tests/validation"),
    "limits": Page("tests/limits/RESULTS.md", "./bench limits",
                   "hil/evidence hil/inspect hil/judge hil/vision tests/limits"),
    "belt-speeds": Page("docs/explanation/belt-speeds.md", "./bench belt-speeds",
                        "firmware_under_test/planner/head firmware_under_test/planner/program tests/belt_speeds "
                        "fixtures/machines/two-mirror-geared.yaml"),
    "tamper": Page("tests/tamper/RESULTS.md", "./bench tamper",
                   "hil/evidence hil/inspect hil/judge hil/report hil/source hil/vision tests/tamper"),
    "witness": Page("tests/witness/RESULTS.md", "./bench witness",
                    "hil/calibrate/camera hil/inspect hil/judge hil/vision tests/witness"),
    "diagnoses": Page("docs/explanation/diagnosis.md", "./bench diagnoses",
                      "hil/diagnose hil/judge/asked_path.cpp hil/judge/diagnosis_evidence.cpp hil/judge/gate_readings.cpp "
                      "hil/judge/timed_cuts.cpp tests/diagnosis"),
    "drawings": Page("docs/explanation/drawings-of-others.md", "./bench drawings",
                     "hil/dieline hil/witness tests/others/others.py tests/others/others.toml tests/others/unpacking.py"),
    "cartons": Page("docs/explanation/drawings-of-others.md", "./bench drawings --cut",
                    "hil/dieline hil/inspect hil/judge hil/vision tests/others/cartons.py tests/others/cartons.toml"),
    "papers": Page("docs/reference/papers.md", "./bench papers",
                   "firmware_under_test/planner tests/papers tests/papers/rows.toml"),
    "ends": Page("tests/ends/RESULTS.md", "./bench ends", "hil/base hil/cli hil/judge hil/scene hil/source tests/ends"),
    "campaigns": Page("tests/campaigns/RESULTS.md", "./bench campaign-proof", "hil/batch hil/campaign tests/campaigns"),
    "mutate": Page("tests/mutation/RESULTS.md", "./bench mutate",
                   "hil/inspect hil/vision tests/hil/inspect tests/hil/vision tests/mutation/mutants.toml"),
    "sampled": Page("tests/mutation/RESULTS_SAMPLED.md", "./bench mutate --sample",
                    "hil/inspect hil/vision/kerf hil/vision/scan tests/hil/inspect tests/hil/judge tests/hil/report "
                    "tests/hil/vision tests/mutation/places.py tests/mutation/sampled.toml"),
}


def digest_of(contents):
    """First 12 digits of the SHA-256 over names and bytes of files, given as bytes by name."""
    whole = hashlib.sha256()
    for name in sorted(contents):
        whole.update(name.encode() + b"\n" + contents[name] + b"\n")
    return whole.hexdigest()[:12]


def counts(name, sources):
    """Whether a file is among these sources: named itself, or code in a folder that is named."""
    return name in sources or (name.endswith(SUFFIXES) and any(name.startswith(source + "/") for source in sources))


def digest_now(sources, root=ROOT):
    """The digest of sources, folders and files with a blank between two, as they are in the tree."""
    sources, contents = sources.split(), {}
    for source in sources:
        path = os.path.join(root, source)
        if not os.path.exists(path):
            raise FileNotFoundError(f"there are no sources {source}")
        found = [path] if os.path.isfile(path) else [
            os.path.join(folder, file) for folder, _, files in os.walk(path) for file in files]
        for file in found:
            name = os.path.relpath(file, root)
            if counts(name, sources):
                with open(file, "rb") as opened:
                    contents[name] = opened.read()
    return digest_of(contents)


def git(*words, root=ROOT):
    """What git prints; None where it fails, as in a tree without history."""
    try:
        done = subprocess.run(["git", "-C", root, *words], capture_output=True, check=False)
    except OSError:
        return None
    return done.stdout if done.returncode == 0 else None


def digest_at(commit, sources, root=ROOT):
    """The digest of sources as a commit has them; None if it lacks one of them."""
    packed = git("archive", "--format=tar", commit, "--", *sources.split(), root=root)
    if packed is None:
        return None
    with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        return digest_of({member.name: archive.extractfile(member).read() for member in archive
                          if member.isfile() and counts(member.name, sources.split())})


def line_of(page, seeds, command="", root=ROOT):
    """The line of a page whose figures are made with the tree as it is. Ask before a run, which may outlast the next commit.

    `seeds` is "seed 1", "seeds 1, 2" or "no seed". A tree without history has no line that anybody takes for one.
    """
    path, usual, sources = PAGES[page]
    commit, date = (git("show", "-s", "--format=%H %cs", "HEAD", root=root) or b"unknown unknown").decode().split()
    digest = digest_now(sources, root)
    changes = "" if digest == digest_at("HEAD", sources, root) else " and changes to it"
    return (f"*Figures of commit {commit[:8]} of {date}{changes}, {seeds}, by `{command or usual}`; of sources "
            f"`{sources}`, {digest}.*")


def line_with_rows_kept(line, path, root=ROOT):
    """The line of a page that takes rows over from the page as it is: theirs, unless both are of the same sources."""
    kept = STAMP.search(read(path)) if os.path.exists(path) else None
    made = STAMP.search(line)
    if kept is None or made and made["digest"] == kept["digest"]:
        return line
    return aged(kept[0], root)


def aged(text, root=ROOT):
    """A text each of whose lines about figures says whether they are older than their sources."""
    def right(stamp):
        is_old = digest_now(stamp["sources"], root) != stamp["digest"]
        return stamp[0].removesuffix(".*").removesuffix(OLD) + (OLD if is_old else "") + ".*"
    return STAMP.sub(right, text)


def pages(root=ROOT):
    """All documents of the tree."""
    found = [os.path.join(root, name) for name in os.listdir(root)]
    for top in TOPS:
        found += [os.path.join(folder, file) for folder, _, files in os.walk(os.path.join(root, top)) for file in files]
    return sorted(path for path in found if path.endswith(".md"))


def read(path):
    with open(path, encoding="utf-8", newline="") as file:
        return file.read()


def write(path, text):
    with open(path + ".new", "w", encoding="utf-8", newline="") as file:
        file.write(text)
    os.replace(path + ".new", path)


def main():
    parser = argparse.ArgumentParser(prog="bench figures", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="which lines are wrong? changes nothing")
    parser.add_argument("--line", nargs=2, metavar=("PAGE", "SEEDS"),
                        help="print the line of figures that are made now: one of " + ", ".join(PAGES))
    try:
        options = parser.parse_args()
        if options.line and options.line[0] not in PAGES:
            parser.error(f"no page is called {options.line[0]}")
    except SystemExit as end:
        return 64 if end.code else 0
    if options.line:
        print(line_of(*options.line))
        return 0
    wrong = 0
    for path in pages():
        text = read(path)
        right = aged(text)
        name = os.path.relpath(path, ROOT)
        for before, after in zip(STAMP.finditer(text), STAMP.finditer(right)):
            if before[0] != after[0]:
                wrong += 1
                print(f"{name}: {'older than' if after['old'] else 'as old as'} their sources: {before[0]}")
        if right != text and not options.check:
            write(path, right)
    return 1 if wrong and options.check else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except OSError as error:
        print(f"figures: {error}", file=sys.stderr)
        sys.exit(2)
