#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Is the cause that a diagnosis names the right one? Seeded faults of many kinds and sizes, pairs of them, and runs without a fault,
on both machines with --imperfections dynamic; each is run, and the named causes are held against what was put in.

Sizes, places and seeds are drawn from --seed; what the diagnosis was tuned with had other seeds. Writes
docs/explanation/diagnosis.md; with --quick, --only or --shard nothing is written but the records in --records, and --merge makes the
page of the records of all shards. Exit code: 0, 1 a quick run named a wrong cause, 2 a run broke, 64 usage.
"""
import argparse
import concurrent.futures
import fnmatch
import json
import os
import random
import subprocess
import sys
import tempfile

import kinds
import page
from jobs import GANTRY, HEAD, ROOT, Place
import limits  # noqa: E402
from job import Job
from recording import Recording
import stamp  # noqa: E402

SEED, TUNED_WITH = 4, 3
FAULTS_OF_A_KIND, PAIRS, GOOD = 4, 40, 300
LEAST, MOST = 1.1, 4.0
QUICK = ("program_rotation", "step_scale", "encoder_scale", "pincushion_missing", "backlash", "gate_late", "pulses_lost",
         "dir_timing", "entity_missing", "kerf_uncompensated")
# What can be done to one and the same run.
OF_PROGRAM = ("program_offset", "program_rotation", "program_scale", "program_shear")
OF_MACHINE = ("step_scale", "sheet_reference", "encoder_scale", "head_offset", "head_shear", "backlash", "axes_lag",
              "spacing", "power_scale")
OF_PINS = ("gate_late", "pulses_lost", "pulses_doubled", "dir_timing")


class Task:
    """A run: a fault, two of them, or none; where; and with which machine."""

    def __init__(self, name, place, seed, made=(), sizes=()):
        self.name, self.place, self.seed, self.made, self.sizes = name, place, seed, made, sizes

    @property
    def job(self):
        jobs = [fault.job for fault in self.made]
        if len(jobs) < 2:
            return jobs[0] if jobs else self.place.job()
        program, others = jobs[0], jobs[1:]
        job = Job(program.marks, program.keys, program.machine, base=program.base, belt=program.belt, files=dict(program.files))
        for other in others:
            own = set(other.keys.splitlines()) - set(job.keys.splitlines())
            job.keys += "".join(line + "\n" for line in sorted(own))
            job.machine += other.machine
            job.files.update({name: text for name, text in other.files.items() if name != "job.gcode"})
            if other.edit is not None:
                job.edit, job.foreign = other.edit, other.foreign
        return job


def kind_of(name):
    return next(k for k in kinds.KINDS if k.name == name)


def drawn_faults(seed):
    tasks = []
    for kind in kinds.KINDS:
        for i in range(FAULTS_OF_A_KIND):
            rng = random.Random(f"{seed}-{kind.name}-{i}")
            place = kind.places[i % len(kind.places)]
            size = LEAST * (MOST / LEAST) ** ((i + rng.random()) / FAULTS_OF_A_KIND)
            tasks.append(Task(f"{kind.name}-{i}", place, rng.randrange(1, 10**6), (kind.make(place, size, rng),), (size,)))
    return tasks


def drawn_pairs(seed):
    tasks, rng = [], random.Random(f"{seed}-pairs")
    while len(tasks) < PAIRS:
        groups = rng.sample((OF_PROGRAM, OF_MACHINE, OF_PINS), 2)
        groups.sort(key=(OF_PROGRAM, OF_MACHINE, OF_PINS).index)
        pair = [kind_of(rng.choice(group)) for group in groups]
        both = [p for p in pair[0].places if any(str(p) == str(q) for q in pair[1].places)]
        if not both:
            continue
        place = rng.choice(both)
        sizes = tuple(rng.uniform(1.5, MOST) for _ in pair)
        made = tuple(kind.make(place, size, rng) for kind, size in zip(pair, sizes))
        tasks.append(Task(f"pair-{len(tasks)}", place, rng.randrange(1, 10**6), made, sizes))
    return tasks


def drawn_good(seed, count=GOOD):
    places = [Place(m, b) for m in (HEAD, GANTRY) for b in ("rest", "even", "varies")]
    return [Task(f"good-{i}", places[i % len(places)], random.Random(f"{seed}-good-{i}").randrange(1, 10**6))
            for i in range(count)]


class Bench:
    def __init__(self, program, folder, kept):
        self.program, self.folder, self.kept = program, folder, kept

    def kerfbench(self, folder, name, seed, *args):
        done = subprocess.run([self.program, *args, "--no-pictures", "--twin", "fast", "--jobs", "1", "--imperfections", "dynamic",
                               "--seed", str(seed), "--keep-evidence", "--results-dir", folder], capture_output=True, text=True)
        if done.returncode not in (0, 1, 3, 4):
            raise limits.Broken(f"{name}: exit code {done.returncode}\n{done.stdout[-1500:]}{done.stderr[-1500:]}")
        return os.path.join(folder, name, "latest")

    def recorded(self, job, seed):
        """Pins of the job before its edit."""
        plain = Job(job.marks, job.keys, job.machine, job.base, job.belt, job.files)
        # A release that was told something else than the scenario says.
        plain.machine, plain.files = getattr(job, "recorded_with", (plain.machine, plain.files))
        with tempfile.TemporaryDirectory(prefix="plain-", dir=self.folder) as folder:
            results = self.kerfbench(folder, "plain", seed, "run", limits.scenario_of("plain", plain, folder))
            return Recording(os.path.join(results, "pins.vcd"))

    def record(self, task):
        """What was put in, and what the diagnosis says."""
        job = task.job
        with tempfile.TemporaryDirectory(prefix="task-", dir=self.folder) as folder:
            scenario = limits.scenario_of(task.name, job, folder)
            if job.edit is None:
                results = self.kerfbench(folder, task.name, task.seed, "run", scenario)
            else:
                recording = self.recorded(job, task.seed)
                job.edit(recording)
                pins = os.path.join(folder, "edited.vcd")
                recording.write(pins, own=not job.foreign)
                results = self.kerfbench(folder, task.name + "-replay", task.seed, "replay", pins, "--scenario", scenario)
            verdict = json.loads(limits.read(os.path.join(results, "verdict.json")))
            if self.kept:
                os.replace(os.path.join(results, "diagnosis-evidence.json"), os.path.join(self.kept, task.name + ".json"))
        return {"name": task.name, "place": str(task.place), "seed": task.seed, "sizes": list(task.sizes),
                "true": [[fault.cause, fault.size] for fault in task.made], "verdict": verdict["verdict"],
                "failing": [c["name"] for c in verdict["checks"] if c["verdict"] == "FAIL"],
                "problems": verdict["problems"][:2], "said": verdict["diagnosis"]["sentence"],
                "causes": verdict["diagnosis"]["causes"]}


def again(program, records, kept):
    """The same runs by the program's present diagnosis of the evidence that was kept."""
    files = [os.path.join(kept, r["name"] + ".json") for r in records]
    done = subprocess.run([program, "diagnose", "--json", *files], capture_output=True, text=True, check=True)
    for record, line in zip(records, done.stdout.splitlines(), strict=True):
        found = json.loads(line)
        record["causes"], record["said"] = found["causes"], found["sentence"]
    return records


def parsed():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="FOLDER")
    parser.add_argument("--seed", type=int, default=SEED, help=f"draws sizes, places and machines; {TUNED_WITH} is what it was tuned with")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="these runs; shell patterns are understood")
    parser.add_argument("--quick", action="store_true", help=f"one fault of each of {len(QUICK)} kinds, and three good runs")
    parser.add_argument("--shard", default="1/1", metavar="I/N", help="every N-th run, from the I-th")
    parser.add_argument("--records", metavar="FILE", help="appends a line of JSON for each run; runs that it has are not repeated")
    parser.add_argument("--keep", metavar="FOLDER", help="keeps the evidence of each run there")
    parser.add_argument("--again", action="store_true", help="diagnoses the evidence in --keep of the runs in --records or --merge again")
    parser.add_argument("--merge", nargs="+", metavar="FILE", help="makes the page of these records, and runs nothing")
    parser.add_argument("--jobs", type=int, default=2, help="runs at once")
    try:
        return parser.parse_args()
    except SystemExit as end:
        sys.exit(64 if end.code else 0)


def chosen(args):
    tasks = drawn_faults(args.seed) + drawn_pairs(args.seed) + drawn_good(args.seed)
    if args.quick:
        names = {f"{name}-0" for name in QUICK} | {f"good-{i}" for i in (0, 1, 3)}
        return [t for t in tasks if t.name in names]
    if args.only:
        tasks = [t for t in tasks if any(fnmatch.fnmatchcase(t.name, p) for p in args.only)]
    index, count = map(int, args.shard.split("/"))
    return tasks[index - 1::count]


def lines_of(files):
    return [json.loads(line) for file in files if os.path.exists(file) for line in limits.read(file).splitlines()]


def run(args, tasks):
    records = lines_of([args.records]) if args.records else []
    had = {r["name"] for r in records}
    program = os.path.join(args.build, "bin", "kerfbench")
    with tempfile.TemporaryDirectory(prefix="kerfbench-diagnosis-") as folder, \
            concurrent.futures.ThreadPoolExecutor(args.jobs) as pool:
        bench = Bench(program, folder, args.keep)
        waiting = [pool.submit(bench.record, task) for task in tasks if task.name not in had]
        broken = []
        for done in concurrent.futures.as_completed(waiting):
            try:
                record = done.result()
            except (limits.Broken, AssertionError) as error:
                broken.append(str(error))
                print(f"diagnoses: {error}", file=sys.stderr, flush=True)
                continue
            records.append(record)
            if args.records:
                with open(args.records, "a", encoding="utf-8") as file:
                    file.write(json.dumps(record) + "\n")
            print(f"[{len(records)}/{len(tasks)}] {page.line_of(record)}", flush=True)
    if broken:
        raise limits.Broken(f"{len(broken)} runs broke, the first: {broken[0]}")
    return records


def main():
    args = parsed()
    made_with = stamp.line_of("diagnoses", f"seed {args.seed}")
    try:
        if args.keep:
            os.makedirs(args.keep, exist_ok=True)
        if not args.merge and not args.again:
            records = run(args, chosen(args))
        else:
            records = lines_of(args.merge or [args.records])
        if args.again:
            records = again(os.path.join(args.build, "bin", "kerfbench"), records, args.keep)
    except (limits.Broken, OSError, subprocess.CalledProcessError) as error:
        print(f"diagnoses: {error}", file=sys.stderr)
        sys.exit(2)
    print(page.summary_of(records))
    if args.quick:
        sys.exit(0 if all(page.is_right(r) for r in records) else 1)
    if not args.only and (args.merge or args.shard == "1/1"):
        stamp.write(os.path.join(ROOT, "docs", "explanation", "diagnosis.md"), page.page_of(records, made_with, args.again))


if __name__ == "__main__":
    main()
