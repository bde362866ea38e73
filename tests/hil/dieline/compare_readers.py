# SPDX-License-Identifier: Apache-2.0
"""Reads drawings of other people's programs with the reader under test and with a second one, and compares length
per process and box to 1 um. Usage: compare_readers.py MEASURE COUNT WRITER…; exit code 77 where a program that a
writer needs is absent."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
from urllib.parse import unquote

import writers

# The product's second reader, as `kerfbench lint --witness` asks it.
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "hil/witness"))
import second_reader  # noqa: E402

LIMIT_MM = 1e-3
SKIPPED = 77
MM_OF_UNIT = {"mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72, "px": 25.4 / 96}
PROCESS_OF_LAYER = {"0": "cut", "CUT": "cut", "CREASE": "crease", "PERF": "perforation"}
PROCESS_OF_STROKE = {"#ff0000": "cut", "#000000": "cut", "#0000ff": "crease", "#00ffff": "perforation"}


def second(path, unit, mm_per_unit):
    """Length per process and box; the second reader must find the unit that the writer meant."""
    try:
        read = second_reader.read(path, path.suffix[1:], MM_OF_UNIT.get(unit))
    except second_reader.Missing as missing:
        raise writers.Absent(missing) from missing
    if abs(read["mm_per_unit"] / mm_per_unit - 1) > 1e-12:
        raise ValueError(f"the second reader takes a unit for {read['mm_per_unit']} mm, not {mm_per_unit}")
    if read["unread"]:
        raise ValueError(f"the second reader does not follow {read['unread']}")
    lengths_mm = {}
    box = [math.inf, math.inf, -math.inf, -math.inf]
    for group in read["groups"]:
        colour = unquote(group["colours"][0])
        if path.suffix == ".svg" and colour == "none":
            continue
        process = PROCESS_OF_STROKE[colour] if path.suffix == ".svg" else PROCESS_OF_LAYER[group["names"][0]]
        lengths_mm[process] = lengths_mm.get(process, 0.0) + group["length_mm"]
        low_x, low_y, high_x, high_y = group["box_mm"]
        box = [min(box[0], low_x), min(box[1], low_y), max(box[2], high_x), max(box[3], high_y)]
    return {"lengths_mm": lengths_mm, "box_mm": box}


def first(measure, path, unit):
    told = ["--unit", unit] if unit else []
    done = subprocess.run([measure, *told, str(path)], capture_output=True, text=True, timeout=60)
    if done.returncode != 0:
        raise ValueError(f"refused: {done.stderr.strip()[:500]}")
    return json.loads(done.stdout)


def differences(ours, theirs):
    """Largest difference of lengths and of the box, mm, and how they were found."""
    processes = set(ours["lengths_mm"]) | set(theirs["lengths_mm"])
    if processes != set(ours["lengths_mm"]) or processes != set(theirs["lengths_mm"]):
        raise ValueError(f"processes {sorted(ours['lengths_mm'])}, the second reader has {sorted(theirs['lengths_mm'])}")
    length = max(abs(ours["lengths_mm"][p] - theirs["lengths_mm"][p]) for p in processes)
    box = max(abs(a - b) for a, b in zip(ours["box_mm"], theirs["box_mm"], strict=True))
    return length, box


def compare(measure, folder, writer, count):
    """Number of drawings that differ."""
    bad = 0
    worst = 0.0
    for n in range(count):
        path, unit, mm_per_unit = writers.WRITERS[writer](folder, n)
        try:
            found = differences(first(measure, path, unit), second(path, unit, mm_per_unit))
        except ValueError as error:
            print(f"{path.name}: {error}")
            bad += 1
            continue
        worst = max(worst, *found)
        if max(found) > LIMIT_MM:
            print(f"{path.name}: lengths differ by {found[0]:.6f} mm, boxes by {found[1]:.6f} mm")
            bad += 1
    print(f"{writer}: {count - bad} of {count} drawings agree, worst {1e3 * worst:.4f} um")
    return bad


def main(measure, count, names):
    bad = 0
    absent = []
    compared = 0
    with tempfile.TemporaryDirectory() as name:
        for writer in names:
            try:
                bad += compare(measure, pathlib.Path(name), writer, count)
                compared += 1
            except writers.Absent as missing:
                print(f"SKIPPED {writer}: {missing} is not installed")
                absent.append(writer)
    print(f"{compared * count} drawings of {compared} writers, {bad} differ")
    if bad:
        return 1
    return SKIPPED if absent else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]), sys.argv[3:]))
