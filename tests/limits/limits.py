#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Faults at the limit: releases with one fault of known size each, 0.8, 1.1, 1.5 and 2 times the limit of the check
that must find it. At 0.8 none may FAIL, from 1.1 on none may PASS, at 2 the right check must FAIL, or be INVALID where
the evidence is at fault.

Writes RESULTS.md; with --only or --quick nothing is written. Ends with 0 if all is so, 1 if not, 2 if a run broke,
64 for a wrong command line.
"""
import argparse
import concurrent.futures
import fnmatch
import json
import os
import re
import subprocess
import sys
import tempfile
import threading

import drawing
from faults import FAULTS
from job import Job
from recording import Recording

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.append(os.path.join(ROOT, "tests", "figures"))
import stamp

PAGE = os.path.join(HERE, "RESULTS.md")
SIZES = (0.8, 1.1, 1.5, 2.0)
# One of each way to put a fault in, just beyond the limit.
QUICK = ("bump-left", "sensor", "lost-y", "safe-lit")
# Checks whose value is a margin, above its limit where all is well.
LOWER = ("ordered_depth", "pulse_timing")
# Checks of docs/reference/checks.md that no fault of this list is for, and why.
WITHOUT = (
    "- `finish`: a controller stops or does not; the scenario `faults/strip-return-slow` has one that stops.",
    "- `belt`: the model's camera and encoder see one and the same web, and a recording whose encoder says otherwise is INVALID "
    "at any size, because its edges are not the machine's. `tests/hil/inspect/belt_test.cpp` has evidence about the limit.",
    "- `spot_seen`: frames without a spot are counted, two in a row are too many, and they are INVALID, never FAIL: laser "
    "or camera may be the cause. `tests/hil/inspect/spot_seen_test.cpp` has such evidence.",
    "- The order of entities has no check: an order that keeps to field and time leaves no trace on the sheet. What a wrong "
    "one leaves out or cuts again is found by `coverage` and `repeat`.",
)


class Broken(Exception):
    pass


def machine_of(base, sections, folder):
    """Writes the machine of a shipped scenario with other sections; the line of the scenario that names it."""
    while (named := re.search(r"^machine: (.*)$", read(base), re.M)) is None:
        base = os.path.join(os.path.dirname(base), re.search(r"^extends: (.*)$", read(base), re.M).group(1))
    machine = os.path.normpath(os.path.join(os.path.dirname(base), named.group(1)))
    text = f"extends: {machine}\nname: {os.path.basename(machine)[:-5]}\n" + sections
    calibrations = {which: f"{machine[:-5]}.{which}.camera.yaml" for which in ("spot", "kerf")}
    found = {which: file for which, file in calibrations.items() if os.path.exists(file)}
    if found:
        text += "cameras:\n" + "".join(f"  {which}: {{calibration: {file}}}\n" for which, file in found.items())
    write(folder, "machine.yaml", text)
    return "machine: machine.yaml\n"


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def write(folder, name, text):
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def scenario_of(name, job, folder):
    """Writes the files of a run; the path of its scenario."""
    base = os.path.join(ROOT, "fixtures", "scenarios", job.base)
    text = f"extends: {base}\nname: {name}\n"
    keys = job.keys if "units" in job.keys else merged("print: {units: 1}\n", job.keys)
    if job.marks is not None:
        write(folder, "drawing.dxf", drawing.dxf())
        write(folder, "job.gcode", drawing.gcode(job.marks))
        text += "dieline: drawing.dxf\n"
        keys = merged(keys, job.belt)
        keys = merged(keys, "planner: {gcode: job.gcode}\n")
        keys = merged(keys, f"checks: {{perforation: {{cut_mm: {drawing.CUT_MM}, bridge_mm: {drawing.BRIDGE_MM}}}}}\n")
    for file, content in job.files.items():
        write(folder, file, content)
    if job.machine:
        text += machine_of(base, job.machine, folder)
    return write(folder, "scenario.yaml", text + keys)


def merged(keys, more):
    """Two texts of lines "section: {…}" or "key: value", a section that both have as one."""
    sections, values = {}, ""
    for line in (keys + more).splitlines():
        if ": {" not in line:
            values += line + "\n"
            continue
        section, content = line.split(": {", 1)
        sections.setdefault(section, []).append(content[:-1])
    return values + "".join(f"{section}: {{{', '.join(parts)}}}\n" for section, parts in sections.items())


class Bench:
    """Runs jobs; the recordings of flawless runs are made once."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.recordings, self.lock = {}, threading.Lock()

    def kerfbench(self, name, folder, *args):
        """The verdict of a run or of a replay."""
        done = subprocess.run([self.program, *args, "--no-pictures", "--twin", "fast", "--jobs", "1", "--results-dir",
                               folder], capture_output=True, text=True)
        if done.returncode not in (0, 1, 3, 4):
            raise Broken(f"{name}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return json.loads(read(os.path.join(folder, name, "latest", "verdict.json")))

    def recorded(self, job):
        """Pins of the job without its edit, on the machine as shipped: a fresh copy."""
        job = Job(job.marks, job.keys, base=job.base, belt=job.belt)
        with tempfile.TemporaryDirectory(prefix="job-", dir=self.folder) as folder:
            scenario = scenario_of("flawless", job, folder)
            key = "".join(read(os.path.join(folder, file)) for file in sorted(os.listdir(folder)))
            with self.lock:
                if key not in self.recordings:
                    verdict = self.kerfbench("flawless", folder, "run", scenario)
                    if verdict["verdict"] != "PASS":
                        raise Broken(f"the flawless run is {verdict['verdict']}: {verdict['summary']}")
                    kept = os.path.join(self.folder, f"{len(self.recordings)}.vcd")
                    os.replace(os.path.join(folder, "flawless", "latest", "pins.vcd"), kept)
                    self.recordings[key] = kept
            return Recording(self.recordings[key])

    def judge(self, fault, factor):
        """Verdict of the run, checks that fail, and the check's own verdict and value."""
        job = fault.make(factor * fault.limit)
        with tempfile.TemporaryDirectory(prefix="fault-", dir=self.folder) as folder:
            scenario = scenario_of(fault.name, job, folder)
            if job.edit is None:
                verdict = self.kerfbench(fault.name, folder, "run", scenario)
            else:
                recording = self.recorded(job)
                job.edit(recording, *([self.recorded(job.beside)] if job.beside else []))
                pins = os.path.join(folder, "edited.vcd")
                recording.write(pins, own=not job.foreign)
                verdict = self.kerfbench(f"{fault.name}-replay", folder, "replay", pins, "--scenario", scenario)
        own = next((c for c in verdict["checks"] if c["name"] == fault.check), None)
        if fault.check == "calibration":
            own = {"verdict": "INVALID" if any("is stale" in p for p in verdict["problems"]) else "PASS", "value": None}
        failing = [c["name"] for c in verdict["checks"] if c["verdict"] == "FAIL"]
        return {"verdict": verdict["verdict"], "failing": failing, "own": own and own["verdict"],
                "value": own and own["value"], "problems": verdict["problems"]}


def wrong(fault, factor, result):
    """What should have been otherwise; empty if nothing."""
    said = f"{fault.name} at {factor:g}: {result['verdict']}"
    if factor < 1.0 and fault.within:
        return "" if result["verdict"] == fault.within else f"{said}, not {fault.within}"
    if result["verdict"] == "INVALID" and (factor < 1.0 or fault.verdict != "INVALID"):
        return f"{said}: {'; '.join(result['problems'])}"
    if factor < 1.0 and result["verdict"] == "FAIL":
        return f"{said} by {', '.join(result['failing'])}"
    if factor > 1.0 and result["verdict"] == "PASS":
        return said
    if factor >= 2.0 and result["own"] != fault.verdict:
        return f"{said}, {fault.check} {result['own']}"
    return ""


def page_of(results, made_with):
    beyond = [(fault, r) for fault in FAULTS for factor, r in results[fault.name].items() if factor > 1.0]
    found = sum(1 for fault, r in beyond if r["verdict"] == fault.verdict)
    lines = ["<!-- SPDX-License-Identifier: Apache-2.0 -->", "<!-- Written by ./bench limits: do not edit. -->",
             "# Faults at the limit", "",
             f"{len(beyond)} faults beyond the limit of the check that must find them, {found} of them FAIL (INVALID where "
             f"the evidence is at fault), none PASS; {len(FAULTS)} within it, none FAIL. "
             f"{', '.join(f'`{f.name}`' for f in FAULTS if f.within)} is INVALID within its limit: the guard of the machine "
             "that replays it stays shut. One unit (two of the strip that is fed), fast twin.", "", made_with, "",
             "Sizes follow from geometry, from the beam's formula or from the clock of a recording, not from what the bench "
             "measures. A cell has the verdict of the run and what the check read, over its limit.", "",
             "| fault | check | limit | " + " | ".join(f"{s:g} ×" for s in SIZES) + " | smallest found |",
             "|---|---|---|" + "---|" * (len(SIZES) + 1)]
    for fault in FAULTS:
        row = results[fault.name]
        cells = []
        for size in SIZES:
            value = None if fault.check in LOWER else row[size]["value"]
            cells.append(row[size]["verdict"] + ("" if value is None else f" {value / fault.limit:.2f}"))
        least = next((f"{s:g} ×" for s in SIZES if row[s]["verdict"] == fault.verdict), "none")
        lines.append(f"| {fault.what} (`{fault.name}`) | {fault.check} | {fault.limit:g} {fault.unit} | "
                     + " | ".join(cells) + f" | {least} |")
    return "\n".join(lines + ["", "## Checks without such a fault", "", *WITHOUT, ""])


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="FOLDER")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these faults; shell patterns are understood")
    parser.add_argument("--quick", action="store_true", help=f"{len(QUICK)} faults at 1.1 times the limit")
    parser.add_argument("--jobs", type=int, default=2, help="runs at once")
    try:
        return parser.parse_args()
    except SystemExit as end:
        sys.exit(64 if end.code else 0)


def judged(bench, tasks, jobs):
    """Results by fault and size, and what should have been otherwise."""
    results, complaints = {}, []
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for number, ((fault, factor), result) in enumerate(zip(tasks, pool.map(lambda t: bench.judge(*t), tasks)), 1):
            results.setdefault(fault.name, {})[factor] = result
            complaint = wrong(fault, factor, result)
            complaints += [complaint] if complaint else []
            print(f"[{number}/{len(tasks)}] {fault.name} at {factor:g}: {result['verdict']}"
                  f" ({fault.check} {result['own']}, {result['value']})", flush=True)
    return results, complaints


def main():
    args = parsed()
    patterns = list(QUICK) if args.quick else args.only or ["*"]
    chosen = [f for f in FAULTS if any(fnmatch.fnmatchcase(f.name, p) for p in patterns)]
    if not chosen:
        print("limits: no fault has such a name: " + ", ".join(f.name for f in FAULTS), file=sys.stderr)
        sys.exit(64)
    tasks = [(fault, factor) for fault in chosen for factor in ((1.1,) if args.quick else SIZES)]
    made_with = stamp.line_of("limits", "seed 1")
    try:
        with tempfile.TemporaryDirectory(prefix="kerfbench-limits-") as folder:
            results, complaints = judged(Bench(os.path.join(args.build, "bin", "kerfbench"), folder), tasks, args.jobs)
    except (Broken, OSError) as error:
        print(f"limits: {error}", file=sys.stderr)
        sys.exit(2)
    for complaint in complaints:
        print(f"limits: {complaint}", file=sys.stderr)
    if not complaints and len(chosen) == len(FAULTS) and not args.quick:
        stamp.write(PAGE, page_of(results, made_with))
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()
