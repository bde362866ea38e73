#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Ends runs at random moments in each of several ways, and looks at what is left: are results old or new, and whole? Is a
process, a temporary folder or a temporary file left? Does the exit code say which signal it was? Writes RESULTS.md. So it does for
disks that become full or read-only and a folder for results that is removed (places.py), where it may mount.

A moment is a share of the time that the run takes when nothing happens to it, drawn by the seed."""
import argparse
import ctypes
import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import places

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENARIO = ROOT / "fixtures/scenarios/native/label-on-belt.yaml"
PR_SET_CHILD_SUBREAPER = 36
SIGNALS = {"SIGINT": signal.SIGINT, "SIGTERM": signal.SIGTERM, "SIGHUP": signal.SIGHUP, "SIGKILL": signal.SIGKILL}
WAYS = [*SIGNALS, "SIGINT twice", "child killed", "two runs into one folder", "output read no more"]
PATIENCE_S = 600  # So long a process may take to end before it counts as left, on a computer with ten times its load.


def children_of(pid):
    """All descendants, by /proc."""
    parents = {}
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                fields = (entry / "stat").read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if fields[0] != "Z":
                parents[int(entry.name)] = int(fields[1])
    found, grown = {pid}, True
    while grown:
        more = {child for child, parent in parents.items() if parent in found} - found
        found |= more
        grown = bool(more)
    return found - {pid}


def reap():
    """Orphans come to this process, which is a subreaper: takes those that have ended."""
    try:
        while os.waitpid(-1, os.WNOHANG)[0] > 0:
            pass
    except ChildProcessError:
        pass


class Place:
    """A folder for results and one for temporary files, with a whole result in it already."""

    def __init__(self, kerfbench):
        self.kerfbench = kerfbench
        self.top = pathlib.Path(tempfile.mkdtemp(prefix="ends-"))
        (self.top / "tmp").mkdir()
        self.results = self.top / "results"
        # One label in place of four: a third of the time, with all that a run does.
        self.scenario = self.top / "one-label.yaml"
        self.scenario.write_text(f"extends: {SCENARIO}\nname: one-label\nprint: {{units: 1}}\n")

    def command(self):
        return [self.kerfbench, "run", str(self.scenario), "--twin", "fast", "--pictures", "--results-dir", str(self.results)]

    def start(self, **kinds):
        environment = dict(os.environ, TMPDIR=str(self.top / "tmp"))
        kinds = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, **kinds}
        return subprocess.Popen(self.command(), env=environment, start_new_session=True, stdin=subprocess.DEVNULL, **kinds)

    def runs(self):
        """Folders of runs, and what is there besides."""
        if not self.results.is_dir():
            return [], []
        runs, rest = [], []
        for path in sorted(self.results.rglob("*")):
            depth = len(path.relative_to(self.results).parts)
            if path.name.startswith("."):
                rest.append(str(path.relative_to(self.results)))
            elif depth == 2 and path.is_dir() and not path.is_symlink():
                runs.append(path)
        return runs, [name for name in rest if not name.endswith(".lock")]

    def broken(self, run):
        """Why a folder of a run is not whole; empty: it is."""
        checked = subprocess.run([self.kerfbench, "verify", str(run)], capture_output=True, text=True, check=False)
        return "" if checked.returncode in (0, 1, 3, 4) and (run / "verdict.json").is_file() else \
            (checked.stdout + checked.stderr).strip()[:200]

    def temporaries(self):
        return sorted(str(p.relative_to(self.top)) for p in (self.top / "tmp").iterdir())

    def remove(self):
        shutil.rmtree(self.top, ignore_errors=True)


def ended(process):
    try:
        return process.wait(PATIENCE_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return None


def end_it(way, place, process, reader):
    """Does it to the process; returns the exit codes that it may have."""
    if way in SIGNALS:
        process.send_signal(SIGNALS[way])
        return {-SIGNALS[way], 0}
    if way == "SIGINT twice":
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGINT)
        return {-signal.SIGINT, 0}
    if way == "child killed":
        for child in children_of(process.pid):
            try:
                os.kill(child, signal.SIGKILL)
            except ProcessLookupError:
                pass
        return {0, 3}  # INVALID, or it was too late.
    if way == "output read no more":
        reader.close()
        return {0}
    raise ValueError(way)


def try_once(way, share, whole_s, kerfbench):
    """What is wrong after one end; empty: nothing."""
    place = Place(kerfbench)
    wrong = []
    try:
        piped = way == "output read no more"
        process = place.start(**({"stdout": subprocess.PIPE} if piped else {}))
        second = None
        if way == "two runs into one folder":
            time.sleep(share * whole_s)
            second = place.start()
        if second is not None:
            allowed = {0}
            if ended(second) not in allowed:
                wrong.append(f"the second run's exit code is {second.returncode}")
        else:
            time.sleep(share * whole_s)
            descendants = children_of(process.pid)
            allowed = end_it(way, place, process, process.stdout)
        code = ended(process)
        if code not in allowed:
            wrong.append(f"exit code {code}, not one of {sorted(allowed)}")
        left = set() if second is not None else descendants
        deadline = time.monotonic() + PATIENCE_S
        while any(pathlib.Path(f"/proc/{pid}").exists() for pid in left) and time.monotonic() < deadline:
            reap()
            time.sleep(0.005)
        wrong += [f"process {pid} is left" for pid in left if pathlib.Path(f"/proc/{pid}").exists()]
        runs, rest = place.runs()
        if way == "SIGKILL":  # Nobody could tidy up: the next run does.
            follower = place.start()
            if ended(follower) != 0:
                wrong.append(f"the next run's exit code is {follower.returncode}")
            runs, rest = place.runs()
            if not runs:
                wrong.append("the next run has left no result")
        wrong += [f"{name} is left" for name in rest + place.temporaries()]
        for run in runs:
            if why := place.broken(run):
                wrong.append(f"{run.name} is not whole: {why}")
        if code == 0 and not runs:
            wrong.append("exit code 0 and no result")
    finally:
        place.remove()
    return wrong


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="build folder")
    parser.add_argument("--moments", type=int, default=1000, help="ends in all (1000)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", choices=[*WAYS, *places.WAYS], help="one way alone")
    parser.add_argument("--page", type=pathlib.Path, help="write the table here")
    return parser.parse_args()


def page(counts, args, made_with):
    rows = "\n".join(f"| {way} | {tried} | {bad} |" for way, (tried, bad) in counts.items())
    return f"""<!-- SPDX-License-Identifier: Apache-2.0 -->
# Runs that are ended at random moments

{made_with}

`./bench ends` starts the run of one label, ends it at a moment that the seed draws, from its start to a little after its end, and looks at what is left.
Wrong is a result that is not whole, a process, a temporary folder or file that stays, or an exit code that does not say what happened. After
`kill -9`, when nobody can tidy up, the next run into the same folder must have done it. A child that is killed makes the run INVALID (exit code 3).
The second of two runs into one folder starts at that moment of the first. Disks have a random size below what the results take (or the temporary
files), or become read-only at the moment; there and where the folder for the results is removed the run may fail, but must say why, and leave no
result that looks whole and is not.

| way | moments | wrong |
|---|---|---|
{rows}
"""


def main():
    args = parse()
    kerfbench = str((args.build / "bin/kerfbench").resolve())
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)
    can_mount = places.own_mounts()
    draw = random.Random(args.seed)
    place = Place(kerfbench)
    begun = time.monotonic()
    if ended(place.start()) != 0:
        sys.exit("the run itself does not PASS")
    whole_s = time.monotonic() - begun
    whole_kib = places.size_of(place.results)
    place.remove()
    ways = [args.only] if args.only else WAYS + (places.WAYS if can_mount else [])
    if not can_mount:
        print("nothing can be mounted here: no full disk, none that becomes read-only, no folder that goes away")
    counts = {way: [0, 0] for way in ways}
    for n in range(args.moments):
        way = ways[n % len(ways)]
        share = draw.uniform(0.0, 1.05)
        if way in places.WAYS:
            place = Place(kerfbench)
            try:
                wrong = places.try_place(way, share, whole_s, whole_kib, place)
            finally:
                place.remove()
        else:
            wrong = try_once(way, share, whole_s, kerfbench)
        counts[way][0] += 1
        counts[way][1] += bool(wrong)
        for text in wrong:
            print(f"{n} {way}: {text}", flush=True)
        if sys.stderr.isatty():
            print(f"\r{n + 1} of {args.moments}", end="", file=sys.stderr, flush=True)
    print(json.dumps({way: {"moments": tried, "wrong": bad} for way, (tried, bad) in counts.items()}))
    if args.page:
        made_with = subprocess.run([sys.executable, "-B", str(ROOT / "tests/figures/stamp.py"), "--line", "ends", f"seed {args.seed}"],
                                   capture_output=True, text=True, check=True).stdout.strip()
        args.page.write_text(page(counts, args, made_with))
    return 1 if any(bad for _, bad in counts.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
