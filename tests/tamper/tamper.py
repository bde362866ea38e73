#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tampers with good evidence in known ways and has it judged again: is any of it accepted in silence?

Two jobs are recorded, of a web that moves and of a sheet at rest. Then
  - their pins are edited, and handed in as they are, with their sum written anew, and without any comment of ours,
  - the files that are judged beside the pins are edited: pictures, calibrations, board, drawing, machine, scenario,
  - a results folder is edited after its verdict, and `kerfbench verify` asked about it.
Evidence that was tampered with has to be FAIL, INVALID, NOT PROVEN or refused. A PASS is right only with other digests, and where
the edit says why a good machine gives such evidence; with the same digests only where nobody reads what was changed.

With the whole list tests/tamper/RESULTS.md is written. Exit code: 0 all as it has to be, 1 not, 2 a run broke, 64 usage.
"""
import argparse
import concurrent.futures
import fnmatch
import os
import sys
import tempfile

import file_edits
import page
import pin_edits
import result_edits
from bench import Bench, Broken

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.append(os.path.join(ROOT, "tests", "figures"))
import stamp

PAGE = os.path.join(HERE, "RESULTS.md")


def tasks_of(bench, chosen, quick):
    """Functions without arguments that return a row's key and its outcome, in the order of the page."""
    for edit in chosen["pins"]:
        for case in ("moving",) if quick else ("moving", "rest"):
            # That a sum does not fit any more is one question for both cases.
            forms = ("summed",) if quick else bench.FORMS if case == "moving" else ("summed", "foreign")
            yield lambda edit=edit, case=case, forms=forms: bench.pins_edited(edit, case, forms)
    for edit in chosen["files"]:
        yield lambda edit=edit: bench.files_edited(edit)
    for edit in chosen["results"]:
        yield lambda edit=edit: bench.results_edited(edit)


def choose(patterns, quick):
    def among(edits):
        return [e for e in edits if any(fnmatch.fnmatchcase(e.name, p) for p in patterns) and (e.quick or not quick)]
    return {"pins": among(pin_edits.EDITS), "files": among(file_edits.EDITS), "results": among(result_edits.EDITS)}


def names():
    return [e.name for e in pin_edits.EDITS + file_edits.EDITS + result_edits.EDITS]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="FOLDER")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these edits; shell patterns are understood")
    parser.add_argument("--quick", action="store_true", help="some edits of each kind, pins with their sum written anew")
    parser.add_argument("--list", action="store_true", help="print the names of the edits, and end")
    parser.add_argument("--jobs", type=int, default=2, help="edits at once")
    try:
        return parser.parse_args()
    except SystemExit as end:
        sys.exit(64 if end.code else 0)


def main():
    args = arguments()
    if args.list:
        print("\n".join(names()))
        return 0
    chosen = choose(args.only or ["*"], args.quick)
    if not any(chosen.values()):
        print("tamper: no edit has such a name: " + ", ".join(names()), file=sys.stderr)
        return 64
    rows, complaints = [], []
    made_with = stamp.line_of("tamper", "seed 1")
    try:
        with tempfile.TemporaryDirectory(prefix="kerfbench-tamper-") as folder:
            bench = Bench(os.path.join(args.build, "bin"), folder)
            bench.prepare(pictures=any(e.case == "photographed" for e in chosen["files"]),
                          rest=bool(chosen["pins"]) and not args.quick)
            tasks = list(tasks_of(bench, chosen, args.quick))
            with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
                for number, row in enumerate(pool.map(lambda task: task(), tasks), 1):
                    rows.append(row)
                    complaints += row.complaints()
                    print(f"[{number}/{len(tasks)}] {row.said()}", flush=True)
            if not complaints and not args.only and not args.quick:
                stamp.write(PAGE, page.page_of(rows, made_with))
    except (Broken, OSError, ValueError) as error:
        print(f"tamper: {error}", file=sys.stderr)
        return 2
    for complaint in complaints:
        print(f"tamper: {complaint}", file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
