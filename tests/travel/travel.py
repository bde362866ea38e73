#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Text that travels: hostile strings in all places that they can enter (names of layers, files, machines, serial numbers, a
controller's words, recordings …), and what a browser, a parser, a terminal, a shell, a spreadsheet or a CI server takes the outputs for
that they reach. `--page` writes the table.

Exit code: 0 nothing is wrong, 1 something is, 64 usage."""
import argparse
import collections
import pathlib
import shutil
import sys
import tempfile

import stages
import strings

QUICK = {"run": ("shell",), "child": ("HTML", "no UTF-8"), "words": ("terminal",), "drawing": ("terminal", "workflow", "XML"), "recording": ("C1",)}


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="build folder")
    parser.add_argument("--quick", action="store_true", help="a few strings for each stage")
    parser.add_argument("--stage", choices=stages.STAGES, help="this one alone")
    parser.add_argument("--string", choices=strings.STRINGS, help="this one alone")
    parser.add_argument("--page", type=pathlib.Path, help="write the table here")
    try:
        return parser.parse_args()
    except SystemExit as end:
        sys.exit(64 if end.code else 0)


def page(reached, wrong, tests):
    places = sorted({place for place, _ in reached})
    outputs = sorted({output for _, output in reached})
    rows = "\n".join(f"| {output} | " + " | ".join(str(len(reached[place, output]) or "") for place in places) + f" | {wrong[output]} |"
                     for output in outputs)
    return f"""<!-- SPDX-License-Identifier: Apache-2.0 -->
# Text that travels

`tests/travel/travel.py --build build/release --page tests/travel/RESULTS.md` puts {len(strings.STRINGS)} hostile strings into all of the places
below, and takes each output as its other side does. In a cell: how many of the strings of that place were found in that output. {tests} outputs
were looked at, {sum(wrong.values())} of them were wrong.

| output | {" | ".join(place.removeprefix("kb") for place in places)} | wrong |
|---|{"---|" * len(places)}---|
{rows}
"""


def main():
    args = parse()
    reached, wrong, tests = collections.defaultdict(set), collections.Counter(), 0
    for stage, function in stages.STAGES.items():
        if args.stage not in (None, stage):
            continue
        for name, text in strings.STRINGS.items():
            if args.string not in (None, name) or (args.quick and name not in QUICK[stage]):
                continue
            folder = tempfile.mkdtemp(prefix="travel-")
            try:
                place = stages.Place((args.build / "bin").resolve(), folder, text)
                function(place)
                for output, parser, content in place.outputs:
                    tests += 1
                    for mark in place.marks:
                        if mark.encode() in content:
                            reached[mark, output].add(name)
                    if faults := parser(content):
                        wrong[output] += 1
                        print(f"{stage}, {name}: {output}: {'; '.join(faults[:3])}", flush=True)
            finally:
                shutil.rmtree(folder, ignore_errors=True)
    print(f"{tests} outputs looked at, {sum(wrong.values())} wrong")
    if args.page:
        args.page.write_text(page(reached, wrong, tests))
    return 1 if wrong or not tests else 0


if __name__ == "__main__":
    sys.exit(main())
