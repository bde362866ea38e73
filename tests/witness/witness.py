#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""An independent witness of the kerf measurement: sheets and calibration targets rendered by POV-Ray from the kerf
camera's pose go the way of a user's pictures: calibrate camera, replay with a folder of pictures, verdict.json.

Writes RESULTS.md; with --only or --quick nothing is written. Rendered pictures are kept in build/witness. Ends with 0 if
lines, widths, corners and ends keep to their goals on all boards, 1 if not, 2 if a program broke, 64 for a wrong command
line.
"""
import argparse
import concurrent.futures
import fnmatch
import os
import re
import shutil
import sys
import tempfile
import threading

import bench
import cases
import figures
import page
import pictures
import scenes
from tracer import Broken, Tracer

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(bench.ROOT, "tests", "figures"))
import stamp

PAGE = os.path.join(HERE, "RESULTS.md")
_lock = threading.Lock()


def say(text):
    with _lock:
        print(text, flush=True)


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(bench.ROOT, "build", "release"), metavar="FOLDER")
    parser.add_argument("--cache", default=os.path.join(bench.ROOT, "build", "witness"), metavar="FOLDER",
                        help="rendered pictures, by a digest of scene and settings")
    parser.add_argument("--only", nargs="+", metavar="NAME",
                        help="lens/board like entocentric/0.4; shell patterns are understood")
    parser.add_argument("--quick", action="store_true", help="one small camera, one thin board")
    parser.add_argument("--keep", metavar="FOLDER", help="keep pictures, calibrations and verdicts here")
    parser.add_argument("--jobs", type=int, default=2, help="pictures and replays at once")
    try:
        return parser.parse_args()
    except SystemExit as end:
        sys.exit(64 if end.code else 0)


def measure(kerfbench, tracer, plan, lens, board_name, pins):
    """Tasks, one for each lay: the readings of all its seeds."""
    case = plan.boards[board_name]

    def task(number):
        lay = plan.lays[number]
        name = f"{re.sub('[^0-9a-z.]+', '-', board_name)}-lay{number}"
        clean = tracer.picture(f"{lens.name}, {name}", scenes.board_scene(lens.camera, plan.sheet, case.board, lay),
                               lens.camera.size_px)
        found = []
        for seed in plan.seeds:
            picture = pictures.exposed(clean, tracer.sensor, 100 * number + seed)
            verdict = bench.judge(kerfbench, plan.sheet, lens, case, picture, f"{name}-seed{seed}", pins)
            found += figures.readings(verdict, plan.sheet, lens, case.board, lay)
            say(f"{lens.name}, {name}, seed {seed}: {verdict['verdict']}"
                + "".join(f"; {problem}" for problem in verdict["problems"]))
        return found
    return [lambda number=number: task(number) for number in range(min(case.lays, len(plan.lays)))]


def witness(plan, chosen, folder, args):
    """Readings by lens and board, and calibrations by lens."""
    kerfbench = bench.Kerfbench(os.path.abspath(os.path.join(args.build, "bin", "kerfbench")), folder)
    tracer = Tracer(os.path.abspath(args.cache), pictures.Sensor(), say)
    lenses = [lens for lens in plan.lenses if any(of is lens for of, _ in chosen)]
    results, calibrations = {}, {}
    with concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        job = pool.submit(bench.run_job, kerfbench, plan.sheet)
        made = {lens.name: pool.submit(bench.calibrate, kerfbench, tracer, lens) for lens in lenses}
        pins = job.result()     # A job that cannot be planned is told before anything is rendered.
        for name, calibration in made.items():
            calibrations[name] = calibration.result()
            say(f"{name}: calibrated, residual {calibrations[name]['rms_px']:.4f} px")
        running = {(lens.name, board): [pool.submit(task) for task in measure(kerfbench, tracer, plan, lens, board, pins)]
                   for lens, board in chosen}
        for row, tasks in running.items():
            results[row] = [reading for task in tasks for reading in task.result()]
            say("\n".join(figures.failing({row: results[row]}) or [f"{row[0]}, board {row[1]}: all goals hold"]))
    return results, calibrations


def main():
    args = options()
    plan = cases.QUICK if args.quick else cases.FULL
    every = [(lens, board) for lens in plan.lenses for board in plan.boards]
    chosen = [(lens, board) for lens, board in every
              if any(fnmatch.fnmatchcase(f"{lens.name}/{board}", pattern) for pattern in args.only or ["*"])]
    if not chosen:
        print("witness: no case has such a name: " + ", ".join(f"{lens.name}/{b}" for lens, b in every), file=sys.stderr)
        sys.exit(64)
    made_with = stamp.line_of("witness", "seeds " + ", ".join(map(str, plan.seeds)))
    folder = os.path.abspath(args.keep) if args.keep else tempfile.mkdtemp(prefix="kerfbench-witness-")
    os.makedirs(folder, exist_ok=True)
    try:
        results, calibrations = witness(plan, chosen, folder, args)
    except (Broken, OSError, ValueError) as error:
        print(f"witness: {error}", file=sys.stderr)
        sys.exit(2)
    finally:
        if not args.keep:
            shutil.rmtree(folder, ignore_errors=True)
    complaints = figures.beyond(results, cases.QUICK_ALLOWS_UM) if args.quick else figures.failing(results)
    for complaint in complaints:
        print(f"witness: {complaint}", file=sys.stderr)
    if len(chosen) == len(every) and not args.quick:
        stamp.write(PAGE, page.text(plan, results, calibrations, made_with))
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()
