#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Faults at the limit: releases with one fault of known size each, 0.8, 1.1, 1.5 and 2 times the limit of the check that
must find it. At 0.8 none may FAIL, from 1.1 on none may PASS, at 2 the right check must FAIL.

Writes RESULTS.md; with --only or --quick nothing is written. Ends with 0 if all is so, 1 if not, 2 if a run broke, 64 for
a wrong command line.
"""
import argparse
import concurrent.futures
import fnmatch
import json
import os
import subprocess
import sys
import tempfile

import drawing
from faults import FAULTS

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
PAGE = os.path.join(HERE, "RESULTS.md")
SIZES = (0.8, 1.1, 1.5, 2.0)
# One of each way to put a fault in, just beyond the limit.
QUICK = ("bump-left", "bridge", "wide")


class Broken(Exception):
    pass


def scenario_of(name, job, folder):
    """Writes the files of a run; the path of its scenario."""
    base = os.path.join(ROOT, "fixtures", "scenarios", job.base)
    text = f"extends: {base}\nname: {name}\nprint: {{units: 1}}\n"
    keys = job.keys
    if job.job is not None:
        with open(os.path.join(folder, "drawing.dxf"), "w", encoding="utf-8") as file:
            file.write(drawing.dxf())
        with open(os.path.join(folder, "job.gcode"), "w", encoding="utf-8") as file:
            file.write(drawing.gcode(job.job))
        text += "dieline: drawing.dxf\nbelt: {speed_mm_s: 30}\n"
        keys = merged(keys, "planner: {gcode: job.gcode}\n")
        keys = merged(keys, f"checks: {{perforation: {{cut_mm: {drawing.CUT_MM}, bridge_mm: {drawing.BRIDGE_MM}}}}}\n")
    if job.controller:
        machine = os.path.join(ROOT, "fixtures", "machines", "two-mirror.yaml")
        cameras = "".join(f"  {which}: {{calibration: {machine[:-5]}.{which}.camera.yaml}}\n" for which in ("spot", "kerf"))
        with open(os.path.join(folder, "machine.yaml"), "w", encoding="utf-8") as file:
            file.write(f"extends: {machine}\nname: two-mirror\n{job.controller}cameras:\n{cameras}")
        text += "machine: machine.yaml\n"
    path = os.path.join(folder, "scenario.yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text + keys)
    return path


def merged(keys, more):
    """Two texts of lines "section: {…}", a section that both have as one."""
    sections = {}
    for line in (keys + more).splitlines():
        section, content = line.split(": {", 1)
        sections.setdefault(section, []).append(content[:-1])
    return "".join(f"{section}: {{{', '.join(parts)}}}\n" for section, parts in sections.items())


def run(program, fault, factor):
    """Verdict of the run, checks that fail, and the check's own verdict and value."""
    name, check, limit, _, make, _ = fault
    with tempfile.TemporaryDirectory(prefix="kerfbench-limits-") as folder:
        scenario = scenario_of(name, make(factor * limit), folder)
        done = subprocess.run([program, "run", scenario, "--no-pictures", "--twin", "fast", "--jobs", "1", "--results-dir",
                               folder], capture_output=True, text=True)
        if done.returncode not in (0, 1, 3, 4):
            raise Broken(f"{name} at {factor:g}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        with open(os.path.join(folder, name, "verdict.json"), encoding="utf-8") as file:
            verdict = json.load(file)
    own = next((c for c in verdict["checks"] if c["name"] == check), None)
    failing = [c["name"] for c in verdict["checks"] if c["verdict"] == "FAIL"]
    return {"verdict": verdict["verdict"], "failing": failing, "own": own and own["verdict"],
            "value": own and own["value"], "problems": verdict["problems"]}


def wrong(fault, factor, result):
    """What should have been otherwise; empty if nothing."""
    name, check = fault[:2]
    said = f"{name} at {factor:g}: {result['verdict']}"
    if result["verdict"] == "INVALID":
        return f"{said}: {'; '.join(result['problems'])}"
    if factor < 1.0 and result["verdict"] == "FAIL":
        return f"{said} by {', '.join(result['failing'])}"
    if factor > 1.0 and result["verdict"] == "PASS":
        return said
    if factor >= 2.0 and result["own"] != "FAIL":
        return f"{said}, {check} {result['own']}"
    return ""


def page_of(results, commit):
    count = sum(1 for row in results.values() for factor in row if factor > 1.0)
    found = sum(1 for row in results.values() for factor, r in row.items() if factor > 1.0 and r["verdict"] == "FAIL")
    lines = ["<!-- SPDX-License-Identifier: Apache-2.0 -->", "<!-- Written by ./bench limits: do not edit. -->",
             "# Faults at the limit", "",
             f"{count} faults beyond the limit of the check that must find them, {found} of them FAIL, none PASS; "
             f"{len(results)} within it, none FAIL. One unit, fast twin, seed 1, commit {commit}.", "",
             "Sizes follow from geometry or the beam's formula, not from what the bench measures. A cell has the verdict of "
             "the run and what the check read, over its limit.", "",
             "| fault | check | limit | " + " | ".join(f"{s:g} ×" for s in SIZES) + " | smallest that FAILs |",
             "|---|---|---|" + "---|" * (len(SIZES) + 1)]
    for fault in FAULTS:
        name, check, limit, unit, _, what = fault
        row = results[name]
        cells = []
        for size in SIZES:
            read = row[size]["value"]
            cells.append(row[size]["verdict"] + (f" {read / limit:.2f}" if read is not None and check != "ordered_depth" else ""))
        least = next((f"{s:g} ×" for s in SIZES if row[s]["verdict"] == "FAIL"), "none")
        lines.append(f"| {what} (`{name}`) | {check} | {limit:g} {unit} | " + " | ".join(cells) + f" | {least} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="FOLDER")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these faults; shell patterns are understood")
    parser.add_argument("--quick", action="store_true", help="three faults at 1.1 times the limit")
    parser.add_argument("--jobs", type=int, default=2, help="runs at once")
    try:
        args = parser.parse_args()
    except SystemExit as end:
        sys.exit(64 if end.code else 0)
    patterns = list(QUICK) if args.quick else args.only or ["*"]
    chosen = [f for f in FAULTS if any(fnmatch.fnmatchcase(f[0], p) for p in patterns)]
    if not chosen:
        print("limits: no fault has such a name: " + ", ".join(f[0] for f in FAULTS), file=sys.stderr)
        sys.exit(64)
    program = os.path.join(args.build, "bin", "kerfbench")
    tasks = [(fault, factor) for fault in chosen for factor in ((1.1,) if args.quick else SIZES)]
    results, complaints = {}, []
    try:
        with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
            for number, (task, result) in enumerate(
                    zip(tasks, pool.map(lambda t: run(program, *t), tasks)), 1):
                fault, factor = task
                results.setdefault(fault[0], {})[factor] = result
                complaint = wrong(fault, factor, result)
                complaints += [complaint] if complaint else []
                print(f"[{number}/{len(tasks)}] {fault[0]} at {factor:g}: {result['verdict']}"
                      f" ({fault[1]} {result['own']}, {result['value']})", flush=True)
    except (Broken, OSError) as error:
        print(f"limits: {error}", file=sys.stderr)
        sys.exit(2)
    for complaint in complaints:
        print(f"limits: {complaint}", file=sys.stderr)
    if not complaints and len(chosen) == len(FAULTS) and not args.quick:
        commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
        with open(PAGE + ".new", "w", encoding="utf-8") as file:
            file.write(page_of(results, commit.stdout.strip() or "unknown"))
        os.replace(PAGE + ".new", PAGE)
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()
