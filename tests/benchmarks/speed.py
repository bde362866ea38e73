#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How fast the bench is, beside what one would otherwise run, on this computer, now.

Whole runs are timed as processes, with all that they start; what is inside of one by Google Benchmark, whose repeats take turns.
A row has the median of the repeats and, in brackets, the least and the most of them. Nothing else should run meanwhile.

--table writes all rows as a Markdown table. --json keeps the figures, and --against such a file says what has become slower than
it was then by more than both spread. --page measures all, and how cost grows with a job's size, and writes docs/explanation/speed.md
with its plots; with --against it says what each row was before. Exit code: 0 done, 1 with --against: something is slower, 2 a program broke, 64 usage.
"""
import argparse
import collections
import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.insert(0, os.path.join(ROOT, "tests", "figures"))
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import flame  # noqa: E402
import growth  # noqa: E402
import stamp  # noqa: E402

SCENARIOS = os.path.join(ROOT, "fixtures", "scenarios")
JOBS = ("label-on-belt", "carton-on-belt", "strip-crosscut")

# values: one for each repeat. better: "more" or "less".
Figure = collections.namedtuple("Figure", "what unit better values")
# other: a Figure of the same unit, or None.
Row = collections.namedtuple("Row", "name own other")


class Broken(Exception):
    pass


def process(*args):
    """Runs a program: what it prints, its wall s, its CPU s with its children, and the peak of the largest in MiB."""
    with tempfile.TemporaryFile("w+") as out:
        begun = time.monotonic()
        started = subprocess.Popen(args, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        _, status, used = os.wait4(started.pid, 0)
        wall_s = time.monotonic() - begun
        started.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        said = out.read()
    if started.returncode != 0:
        raise Broken(f"{' '.join(args)}: exit code {started.returncode}\n{said}")
    return said, wall_s, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0


def whole_runs(bench):
    """From the drawing to the report, without pictures of the machine: a test on the machine takes the job's own time."""
    rows = []
    for kind, folder in (("AVR", ""), ("native", "native")):
        for job in JOBS:
            scenario = os.path.join(SCENARIOS, folder, job + ".yaml")
            times, costs, peaks = [], [], []
            for _ in range(bench.repeats):
                said, wall_s, cpu_s, peak_mib = process(bench.program("kerfbench"), "run", scenario, "--twin", "fast", "--timing",
                                                        "--no-pictures", "--results-dir", bench.folder)
                simulated_s = float(re.search(r"in all for ([\d.]+) simulated s", said).group(1))
                times.append(simulated_s / wall_s)
                costs.append(cpu_s / simulated_s)
                peaks.append(peak_mib)
            on_machine = Figure("the job on the machine", "× real time", "more", [1.0])
            rows += [Row(f"run, {kind}: {job}", Figure("kerfbench run", "× real time", "more", times), on_machine),
                     Row(f"cost, {kind}: {job}", Figure("kerfbench run", "CPU s per simulated s", "less", costs), None),
                     Row(f"memory, {kind}: {job}", Figure("kerfbench run", "MiB", "less", peaks), None)]
    return rows


def google(bench, program):
    """Counters by benchmark, one of each repeat; the repeats of all benchmarks take turns."""
    file = os.path.join(bench.folder, program + ".json")
    process(bench.program(program), f"--benchmark_out={file}", "--benchmark_out_format=json",
            f"--benchmark_repetitions={bench.repeats}", "--benchmark_enable_random_interleaving=true")
    found = collections.defaultdict(list)
    with open(file, encoding="utf-8") as opened:
        for run in json.load(opened)["benchmarks"]:
            if run["run_type"] == "iteration":
                found[run["run_name"].split("/")[0]].append(run)
    return found


def counted(runs, what, name, counter, unit, better="more", scale=1.0):
    if not runs[name]:
        raise Broken(f"no benchmark is called {name}")
    return Figure(what, unit, better, [scale * run[counter] for run in runs[name]])


def twin_and_pins(bench):
    runs = google(bench, "kerfbench-benchmarks")
    bullet = counted(runs, "plain Bullet, steps of 1 µs", "bullet stepSimulation, 1 us", "x real time", "× real time")
    rows = [Row(f"twin, {mode}: {job}", counted(runs, "twin", f"twin, {mode}: {job}-native", "x real time", "× real time"), None)
            for mode in ("fast", "fast, dynamic imperfections", "reference") for job in JOBS]
    rows += [Row(f"model, {mode}", counted(runs, "model of the head", f"model, {mode}", "x real time", "× real time"), bullet)
             for mode in ("fast", "reference")]
    checked = counted(runs, "readVcd, checked", "recording, checked", "edges/s", "M edges/s", scale=1e-6)
    lines = counted(runs, "std::getline alone", "recording, lines alone", "edges/s", "M edges/s", scale=1e-6)
    rows.append(Row("recording", checked, lines))
    own = counted(runs, "readVcd, checked", "recording of one run, checked", "edges/s", "M edges/s", scale=1e-6)
    account = counted(runs, "all axes, timing", "recording of one run, positions and timing", "edges/s", "M edges/s", scale=1e-6)
    session = counted(runs, "readSr, checked", "session of one run, checked", "edges/s", "M edges/s", scale=1e-6)
    edges = {file: runs[name][0]["edges"] for file, name in (("run.vcd", "recording of one run, checked"),
                                                             ("run.sr", "session of one run, checked"))}

    def sigrok(what, file, *args):
        """Edges a second of processor time."""
        if not shutil.which("sigrok-cli"):
            return None
        path = os.path.join(bench.build, "benchmarks", file)
        return Figure(what, "M edges/s", "more", [1e-6 * edges[file] / process("sigrok-cli", "-i", path, *args)[2]
                                                  for _ in range(bench.repeats)])

    # Sampled at each tick of 62.5 ns: at the file's own 100 ps it would take hours.
    by_ticks = ("-I", "vcd:downsample=625")
    stepper = ("-P", "stepper_motor:step=galvo_x_pul:dir=galvo_x_dir", "-A", "stepper_motor")
    rows += [Row("recording of one run", own, sigrok("sigrok-cli", "run.vcd", *by_ticks, "-O", "null")),
             Row("recording of one run, judged", account, sigrok("sigrok-cli, stepper_motor, one axis", "run.vcd", *by_ticks, *stepper)),
             Row("session of one run, 1 MHz", session, sigrok("sigrok-cli", "run.sr", "-O", "null"))]
    return rows


def pictures(bench):
    spots = google(bench, "kerfbench-spot-benchmarks")
    kerfs = google(bench, "kerfbench-kerf-benchmarks")
    microseconds = ("cpu_time", "µs", "less")
    milliseconds = ("cpu_time", "ms", "less")
    return [
        Row("spot in 2448 x 2048 px", counted(spots, "found and fitted", "spotFoundAndFitted", *microseconds),
            counted(spots, "OpenCV's SimpleBlobDetector, tuned", "simpleBlobDetectorTuned", *microseconds)),
        Row("spot, error", counted(spots, "found and fitted", "spotFoundAndFitted", "rms_px", "px RMS", "less"),
            counted(spots, "OpenCV's SimpleBlobDetector, tuned", "simpleBlobDetectorTuned", "rms_px", "px RMS", "less")),
        Row("kerf, 400 x 300 mm, whole", counted(kerfs, "measured", "measureSheet", *milliseconds), None),
        Row("kerf, 400 x 300 mm, whole, on all processors",
            counted(kerfs, "measured", "measureSheetOnAll", "real_time", "ms", "less"), None),
        Row("kerf, 400 x 300 mm, path", counted(kerfs, "calipers", "pathByCalipers", *milliseconds),
            counted(kerfs, "OpenCV: threshold, distances", "pathByDistanceTransform", *milliseconds)),
    ]


def start(bench):
    """Programs that start in turns."""
    kerfbench = bench.program("kerfbench")
    commands = {"kerfbench --version": (kerfbench, "--version"),
                "kerfbench lint": (kerfbench, "lint", os.path.join(SCENARIOS, "label-on-belt.yaml"))}
    if shutil.which("sigrok-cli"):
        commands["sigrok-cli --version"] = ("sigrok-cli", "--version")
    times = collections.defaultdict(list)
    for _ in range(4 * bench.repeats):
        for what, args in commands.items():
            times[what].append(1e3 * process(*args)[1])
    figures = {what: Figure(what, "ms", "less", values) for what, values in times.items()}
    return [Row("start", figures["kerfbench --version"], figures.get("sigrok-cli --version")),
            Row("lint", figures["kerfbench lint"], None)]


PARTS = {"runs": whole_runs, "twin": twin_and_pins, "pictures": pictures, "start": start}


class Bench:
    def __init__(self, build, folder, repeats):
        self.build, self.folder, self.repeats = build, folder, repeats

    def program(self, name):
        return os.path.join(self.build, "bin", name)


def said(figure):
    def number(value):
        return f"{value:.3g}" if value < 1000 else f"{value:.0f}"
    least, most = min(figure.values), max(figure.values)
    text = number(statistics.median(figure.values))
    return text + (f" ({number(least)} … {number(most)})" if most > least else "") + f" {figure.unit}"


def ratio(row):
    """How many times better than the other, at the medians."""
    own, other = statistics.median(row.own.values), statistics.median(row.other.values)
    return own / other if row.own.better == "more" else other / own


def line_of(row, before=None):
    cells = [row.name, f"{row.own.what}: {said(row.own)}"]
    if before is not None:
        cells.append(said(row.own._replace(values=before[row.name]["values"])) if row.name in before else "")
    cells += ["", ""] if row.other is None else [f"{row.other.what}: {said(row.other)}", f"{ratio(row):.3g}"]
    return cells


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        return next((line.split(":", 1)[1].strip() for line in file if line.startswith("model name")), "an unknown processor")


def table_of(rows, repeats, before=None):
    commit = (stamp.git("show", "-s", "--format=%h of %cs", "HEAD") or b"unknown").decode().strip()
    titles = ["what", "the bench", *([] if before is None else ["before"]), "otherwise", "×"]
    lines = ["Each row is measured beside what one would otherwise run, on the same computer. Whole runs go from the "
             "drawing to the report, with the fast twin and without pictures of the machine, on all processors; the job on the "
             "machine takes its own time. A figure is the median of its repeats, with the least and the most of them; × is how "
             "many times better the bench is.", "",
             f"Commit {commit}, {os.cpu_count()} processors, {processor()}; {repeats} repeats.", "",
             f"| {' | '.join(titles)} |", "|" + "---|" * len(titles)]
    lines += [f"| {' | '.join(line_of(row, before))} |" for row in rows]
    return "\n".join(lines + [""])


PAGE = """<!-- SPDX-License-Identifier: Apache-2.0 -->
# How fast the bench is

`./bench benchmark --page` rewrites this page. It needs a quiet computer.

{table}
{before}
## Where the time goes

A box is as wide as the share of the processor's time that went into a function and into all that it calls. The lowest boxes do the work.
`kerfbench-avr` is the emulated controller, a process of its own.

![Flame graph of a run of label-on-belt](speed-flame.svg)

## How cost grows

Both axes are logarithmic. Beside each curve stands the power of the size with which it grows over the larger sizes: 1 is in proportion.

{plots}
"""


def page_of(rows, repeats, before, before_commit, plots):
    told = f"\n*Before* is commit {before_commit}, on the same computer.\n" if before is not None else ""
    shown = "\n".join(f"![{plot.title}](speed-{plot.name}.svg)\n" for plot in plots)
    return PAGE.format(table=table_of(rows, repeats, before), before=told, plots=shown.rstrip("\n"))


def write_page(args, rows, before, kept):
    folder = os.path.join(ROOT, "docs", "explanation")
    kerfbench = os.path.join(args.build, "bin", "kerfbench")
    with tempfile.TemporaryDirectory(prefix="kerfbench-speed-") as scratch:
        print("benchmark: growth", file=sys.stderr, flush=True)
        plots = growth.plots(process, kerfbench, SCENARIOS, scratch)
        print("benchmark: flame graph", file=sys.stderr, flush=True)
        stacks = flame.stacks_of(flame.sampled([kerfbench, "run", os.path.join(SCENARIOS, "label-on-belt.yaml"), "--twin", "fast",
                                                "--no-pictures", "--results-dir", scratch]))
    for plot in plots:
        stamp.write(os.path.join(folder, f"speed-{plot.name}.svg"), growth.svg_of(plot))
    stamp.write(os.path.join(folder, "speed-flame.svg"), flame.svg_of(stacks, f"label-on-belt: {len(stacks)} samples"))
    stamp.write(os.path.join(folder, "speed.md"), page_of(rows, args.repeats, before, kept.get("commit", "unknown"), plots))


def slower(rows, before):
    """Rows that got worse than they were by more than both spread."""
    found = []
    for row in rows:
        then = before.get(row.name)
        if then is None:
            continue
        worse = (max(row.own.values) < min(then["values"]) if row.own.better == "more"
                 else min(row.own.values) > max(then["values"]))
        if worse:
            found.append(f"{row.name}: {said(row.own)}, was {said(row.own._replace(values=then['values']))}")
    return found


def parsed():
    parser = argparse.ArgumentParser(prog="bench benchmark", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="FOLDER")
    parser.add_argument("--only", nargs="+", metavar="PART", choices=sorted(PARTS),
                        help="these parts: " + ", ".join(PARTS))
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="of each figure; default 5")
    parser.add_argument("--table", metavar="FILE", help="write the rows as a Markdown table")
    parser.add_argument("--page", action="store_true", help="rewrite docs/explanation/speed.md")
    parser.add_argument("--json", metavar="FILE", help="keep the figures")
    parser.add_argument("--against", metavar="FILE", help="figures kept earlier, on the same computer")
    try:
        args = parser.parse_args()
        if args.repeats < 1:
            parser.error("--repeats must be 1 or more")
        return args
    except SystemExit as end:
        sys.exit(64 if end.code else 0)


def measured(args):
    rows = []
    with tempfile.TemporaryDirectory(prefix="kerfbench-speed-") as folder:
        bench = Bench(args.build, folder, args.repeats)
        for part in args.only or PARTS:
            print(f"benchmark: {part}", file=sys.stderr, flush=True)
            more = PARTS[part](bench)
            rows += more
            for row in more:
                print(" | ".join(cell for cell in line_of(row) if cell), flush=True)
    return rows


def main():
    args = parsed()
    try:
        kept = {}
        if args.against:
            with open(args.against, encoding="utf-8") as file:
                kept = json.load(file)
        before = kept["rows"] if kept else None
        rows = measured(args)
        if args.json:
            commit = (stamp.git("show", "-s", "--format=%h of %cs", "HEAD") or b"unknown").decode().strip()
            stamp.write(args.json, json.dumps({"commit": commit, "rows": {row.name: row.own._asdict() for row in rows}}, indent=1)
                        + "\n")
        if args.page:
            write_page(args, rows, before, kept)
        if args.table:
            stamp.write(args.table, table_of(rows, args.repeats))
    except (Broken, KeyError, OSError, RuntimeError, ValueError, subprocess.CalledProcessError) as error:
        print(f"benchmark: {error}", file=sys.stderr)
        return 2
    found = slower(rows, before) if before is not None else []
    for line in found:
        print(f"slower: {line}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
