#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does the bench live long? A hundred runs in one process, and a line that runs longer and longer: memory, descriptors and time of each
run. With --page FILE the tables are written there. Exit code: 0 all of it stays flat or within its bounds,
1 something grows, 2 something broke, 64 usage."""
import argparse
import csv
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "fixtures/scenarios/native"
HOUR_S, MIB = 3600.0, 1024.0 * 1024.0
UNITS = (2, 4, 8, 16)
# A bench whose runs leave more than this behind would need a gigabyte more after some 16 000 of them.
MOST_LEFT_BYTES = 64 * 1024
# The heap of an hour of a line, and what the system may not take away from a process.
MOST_HOUR_MIB = 2048.0


class Broken(Exception):
    pass


def parsed():
    parser = argparse.ArgumentParser(prog="bench life", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, required=True, help="build folder")
    parser.add_argument("--runs", type=int, default=100, help="runs in one process (100)")
    parser.add_argument("--units", type=int, nargs="+", default=list(UNITS), help="units on the web, the longest last")
    parser.add_argument("--hour", action="store_true", help="an hour of the line as well")
    parser.add_argument("--only", choices=("runs", "line"), help="one part alone; no page is written")
    parser.add_argument("--page", type=pathlib.Path, metavar="FILE", help="write the tables of all parts there")
    try:
        return parser.parse_args()
    except SystemExit as end:
        sys.exit(64 if end.code else 0)


class Watched:
    """A process that has ended, with the most that it and its children have taken."""

    def __init__(self, command, folder):
        self.anonymous_kib = self.files_kib = self.own_peak_kib = 0
        log = folder / "log"
        begun = time.monotonic()
        with open(log, "wb") as out:
            process = subprocess.Popen([str(word) for word in command], stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                       env=dict(os.environ, TMPDIR=str(folder)))
        while True:
            self.look(process.pid)
            pid, status, used = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            time.sleep(0.05)
        process.returncode = self.code = os.waitstatus_to_exitcode(status)
        self.wall_s = time.monotonic() - begun
        self.cpu_s = used.ru_utime + used.ru_stime
        self.peak_mib = used.ru_maxrss / 1024.0  # Of the process or of one of its children, whichever is larger.
        self.said = log.read_text(errors="replace")
        if self.code != 0:
            raise Broken(f"{' '.join(map(str, command))}: exit code {self.code}\n{self.said[-2000:]}")

    def look(self, pid):
        try:
            status = pathlib.Path(f"/proc/{pid}/status").read_text()
        except OSError:
            return
        def of(name):
            found = re.search(rf"^{name}:\s+(\d+)", status, re.M)
            return int(found.group(1)) if found else 0
        self.anonymous_kib = max(self.anonymous_kib, of("RssAnon"))
        self.files_kib = max(self.files_kib, of("RssFile"))
        self.own_peak_kib = max(self.own_peak_kib, of("VmHWM"))


def slope(points):
    """Of a straight line through (x, y)."""
    mean_x = statistics.fmean(x for x, _ in points)
    mean_y = statistics.fmean(y for _, y in points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def scenario(folder, name, base, changes):
    path = folder / f"{name}.yaml"
    path.write_text(f"extends: {base}\nname: {name}\n{changes}")
    return path


# --- many runs in one process


def many_runs(build, runs, folder):
    label = scenario(folder, "one-label", SCENARIOS / "label-on-belt.yaml", "print: {units: 1}\n")
    said = Watched([build / "bin/kerfbench-life", runs, label, folder / "many"], folder).said
    lines = [line for line in said.splitlines() if re.match(r"run,|\d+,", line)]  # Beside them each run tells its verdict.
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


def runs_table(rows):
    shown = [row for row in rows if row["run"] in (1, 2, 5, 10, 20, 50, len(rows) // 2, len(rows))]
    lines = ["| run | heap in use after it | most in it | resident | descriptors | threads | CPU |", "|---|---|---|---|---|---|---|"]
    for row in shown:
        lines.append(f"| {row['run']:.0f} | {row['heap_bytes'] / 1024:.0f} KiB | {row['heap_peak_bytes'] / MIB:.1f} MiB | "
                     f"{row['rss_kib'] / 1024:.1f} MiB | {row['descriptors']:.0f} | {row['threads']:.0f} | {row['cpu_s']:.2f} s |")
    return "\n".join(lines)


def judged_runs(rows):
    """What is said of them, and what is wrong."""
    later = rows[len(rows) // 10:]  # Tables and caches that live as long as the program are there by then.
    left = slope([(row["run"], row["heap_bytes"]) for row in later])
    resident = slope([(row["run"], row["rss_kib"]) for row in later])
    half = len(later) // 2
    first, second = (statistics.median(row["cpu_s"] for row in part) for part in (later[:half], later[half:]))
    wrong = []
    if left > MOST_LEFT_BYTES:
        wrong.append(f"a run leaves {left:.0f} bytes of the heap behind")
    if rows[-1]["descriptors"] != rows[1]["descriptors"]:
        wrong.append(f"{rows[-1]['descriptors']:.0f} descriptors after the last run, {rows[1]['descriptors']:.0f} after the second")
    if rows[-1]["threads"] != rows[1]["threads"]:
        wrong.append(f"{rows[-1]['threads']:.0f} threads after the last run, {rows[1]['threads']:.0f} after the second")
    text = (f"From the {later[0]['run']:.0f}th run on, each leaves {left:+.0f} bytes of the heap and {resident:+.2f} KiB of resident memory "
            f"behind (straight line through all). Median CPU time of a run: {first:.2f} s in the first half, {second:.2f} s in the second.")
    return text, wrong


# --- one line that runs longer and longer


def carton(folder, units):
    return scenario(folder, f"carton-{units}", SCENARIOS / "carton-on-belt.yaml",
                    f"print: {{units: {units}, pitch_mm: 170}}\ntime_limit_s: {min(3600, 30 + 6 * units)}\n")


def one_line(build, units, folder):
    results = folder / "line"
    run = Watched([build / "bin/kerfbench", "run", carton(folder, units), "--twin", "fast", "--no-pictures", "--jobs", "2", "--timing",
                   "--results-dir", results], folder)
    simulated = re.search(r"in all for ([\d.]+) simulated s", run.said)
    digest = re.search(r"digest: ([0-9a-f]+)", run.said)
    bytes_kept = sum(path.stat().st_size for path in results.rglob("*") if path.is_file() and not path.is_symlink())
    shutil.rmtree(results)
    return {"units": units, "simulated_s": float(simulated.group(1)), "anonymous_mib": run.anonymous_kib / 1024.0,
            "files_mib": run.files_kib / 1024.0, "peak_mib": run.peak_mib, "cpu_s": run.cpu_s, "results_mib": bytes_kept / MIB,
            "digest": digest.group(1)[:12]}


def line_table(rows):
    lines = ["| units | simulated | memory of its own | of files | most together | CPU for a simulated second | results |", "|---|---|---|---|---|---|---|"]
    for row in rows:
        lines.append(f"| {row['units']} | {row['simulated_s']:.1f} s | {row['anonymous_mib']:.0f} MiB | {row['files_mib']:.0f} MiB | "
                     f"{row['peak_mib']:.0f} MiB | {row['cpu_s'] / row['simulated_s']:.2f} s | {row['results_mib']:.1f} MiB |")
    return "\n".join(lines)


def judged_line(rows):
    usual = [row for row in rows if row["simulated_s"] < 3000.0] or rows
    longer = usual[len(usual) // 2 - (len(usual) < 4):]  # Where what any run takes no longer tells.
    if len(rows) < 2:
        return "One length tells no growth.", []
    growth = slope([(row["simulated_s"], row["anonymous_mib"]) for row in longer]) if len(longer) > 1 else 0.0
    hour_mib = longer[-1]["anonymous_mib"] + growth * (HOUR_S - longer[-1]["simulated_s"])
    if rows[-1]["simulated_s"] >= 3000.0:
        hour_mib = rows[-1]["anonymous_mib"]
        text = f"An hour was run: {hour_mib:.0f} MiB of memory of its own at most."
    else:
        text = f"Each simulated second takes {1024 * growth:.0f} KiB more; an hour would take {hour_mib:.0f} MiB."
    wrong = [f"an hour of the line takes {hour_mib:.0f} MiB"] if hour_mib > MOST_HOUR_MIB else []
    return text, wrong


# --- the page


def page(parts, made_with):
    text = f"""<!-- SPDX-License-Identifier: Apache-2.0 -->
<!-- Written by ./bench life: do not edit. -->
# How long the bench lives

{made_with}

All runs are with the fast twin, two threads and no pictures of the machine.
"""
    if "runs" in parts:
        rows, said = parts["runs"]
        text += f"""
## {len(rows)} runs in one process

One label on the web, its release a process of its own, from the scenario to the results. "Heap" is counted in `malloc()` and `free()`.

{runs_table(rows)}

{said}
"""
    if "line" in parts:
        rows, said = parts["line"]
        text += f"""
## A line that runs longer and longer

Cartons on the belt at 30 mm/s, 170 mm from one to the next. "Memory of its own" is what the system cannot take away from the process;
pages of files, the program itself and the recording of the pins among them, are read again when they are wanted.

{line_table(rows)}

{said}
"""
    return text


def main():
    args = parsed()
    commit = subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"], capture_output=True, text=True, check=False).stdout.strip()
    command = f"./bench life --runs {args.runs} --units {' '.join(map(str, args.units))}" + (" --hour" if args.hour else "")
    made_with = f"Commit {commit or 'unknown'}, seed 1, by `{command}`."
    build = args.build.resolve()
    parts, wrong = {}, []
    with tempfile.TemporaryDirectory(prefix="life-", dir=os.environ.get("TMPDIR", "/var/tmp")) as name:
        folder = pathlib.Path(name)
        if args.only in (None, "runs"):
            rows = many_runs(build, args.runs, folder)
            said, bad = judged_runs(rows)
            parts["runs"], wrong = (rows, said), wrong + bad
            print(runs_table(rows), said, sep="\n", flush=True)
        if args.only in (None, "line"):
            rows = []
            for units in args.units + ([625] if args.hour else []):
                rows.append(one_line(build, units, folder))
                print(rows[-1], flush=True)
            said, bad = judged_line(rows)
            parts["line"], wrong = (rows, said), wrong + bad
            print(said, flush=True)
    for text in wrong:
        print(f"wrong: {text}")
    if args.page and not args.only:
        args.page.write_text(page(parts, made_with))
    return 1 if wrong else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (Broken, OSError, subprocess.CalledProcessError) as error:
        print(f"life: {error}", file=sys.stderr)
        sys.exit(2)
