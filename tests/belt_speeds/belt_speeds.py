#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Up to which speed of the belt geared steppers hold the dieline: the plate of fixtures/scenarios/geared/plate.yaml at rest and
on belts of more and more speed, until the unit leaves the field before it is done. Twice: as shipped, and by a controller
that does for the rotors nothing of what the planner can.

Writes docs/explanation/belt-speeds.md and belt-speeds.svg; with --quick nothing is written. Exit code: 0 as shipped it passes
at the highest speeds that can be planned, 1 it does not, 2 a run broke, 64 usage.
"""
import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.append(os.path.join(ROOT, "tests", "figures"))
import stamp  # noqa: E402

SEED = 1
PAGE = "belt-speeds.md"
PLOT = "belt-speeds.svg"
SCENARIO = "fixtures/scenarios/geared/plate.yaml"
MACHINE = "fixtures/machines/two-mirror-geared.yaml"
# Mark speed in mm/s, acceleration in mm/s2, and speeds of the belt. The last of each is beyond what fits the field.
JOBS = (
    (60, 1000, (0, 3, 4, 5, 6, 8, 10, 15, 20, 25, 26.7, 30, 32, 36)),
    (150, 3000, (0, 20, 40, 50, 60, 70, 85)),
)
WAYS = {
    "shipped": ("as shipped", ""),
    "plain": ("nothing done for the rotors", "controller: {detent_share: 0, rotor_resonance_hz: 0, rotor_damping: 0}\n"),
}
CHECKS = ("path", "joints", "stillness_x", "stillness_peak")
VERDICTS = {0: "PASS", 1: "FAIL", 3: "INVALID", 4: "NOT PROVEN", 65: "not planned"}
LIMIT_MM = 0.05
LONGEST_S = 300  # Time until a slow belt has brought and carried off the unit.


class Broken(Exception):
    """A run of which nothing can be told."""


class Run:
    """One run of the plate."""

    def __init__(self, way, mark, acceleration, speed):
        self.way, self.mark, self.acceleration, self.speed = way, mark, acceleration, speed
        self.name = f"{way}-{mark:g}-{speed:g}".replace(".", "_")
        self.verdict, self.values, self.unproven, self.reason = "", {}, [], ""

    def files(self, folder):
        """Writes the scenario; its path."""
        lines = [f"extends: {os.path.join(ROOT, SCENARIO)}", f"name: {self.name}", f"time_limit_s: {LONGEST_S}"]
        if WAYS[self.way][1]:
            machine = os.path.join(folder, self.way + ".yaml")
            write(machine, f"extends: {os.path.join(ROOT, MACHINE)}\nname: {self.way}\n{WAYS[self.way][1]}")
            lines.append(f"machine: {machine}")
        if self.speed > 0:
            lines.append(f"belt: {{speed_mm_s: {self.speed:g}, start_x_mm: ~}}")
        lines.append(f"planner: {{mark_speed_mm_s: {self.mark:g}, jump_speed_mm_s: {max(100, self.mark):g}, "
                     f"acceleration_mm_s2: {self.acceleration:g}}}")
        path = os.path.join(folder, self.name + ".yaml")
        write(path, "\n".join(lines) + "\n")
        return path

    def go(self, build, folder):
        done = subprocess.run(
            [os.path.join(build, "bin", "kerfbench"), "run", self.files(folder), "--twin", "fast", "--no-pictures",
             "--jobs", "1", "--seed", str(SEED), "--results-dir", os.path.join(folder, "results")],
            capture_output=True, text=True, check=False)
        said = done.stdout + done.stderr
        self.verdict = VERDICTS.get(done.returncode, "")
        if not self.verdict or (done.returncode == 65 and "cannot be planned" not in said):
            raise Broken(f"{self.name} ends with {done.returncode}:\n{said[-2000:]}")
        if done.returncode == 65:
            self.reason = said.split("cannot be planned:", 1)[1].split("\n")[0].strip()
            return self
        with open(os.path.join(folder, "results", self.name, "latest", "verdict.json"), encoding="utf-8") as file:
            verdict = json.load(file)
        for check in verdict["checks"]:
            if check["name"] in CHECKS and check.get("value") is not None:
                self.values[check["name"]] = (check["value"], check["expanded_uncertainty"])
            if check["verdict"] != "PASS":
                self.unproven.append(f"{check['name']} {check['verdict']}")
        return self


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def runs_of(quick):
    if quick:
        return [Run("shipped", 60, 1000, 25), Run("shipped", 60, 1000, 36)]
    return [Run(way, mark, acceleration, speed)
            for way in WAYS for mark, acceleration, speeds in JOBS for speed in speeds]


def panel(lines, runs, top, title):
    """One panel of the plot: path and joints with their U over the speed of the belt."""
    left, width, height, most_mm, most_v = 60, 600, 220, 0.12, 90.0
    across = lambda v: left + width * v / most_v
    up = lambda mm: top + height * (1.0 - min(max(mm, 0.0), most_mm) / most_mm)
    lines.append(f'<text x="{left}" y="{top - 8}" font-weight="bold">{title}</text>')
    lines.append(f'<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="none" stroke="#888"/>')
    for mm in (0.0, 0.02, 0.04, 0.06, 0.08, 0.10, 0.12):
        lines.append(f'<text x="{left - 6}" y="{up(mm) + 4:.1f}" text-anchor="end">{mm:.2f}</text>')
    for v in range(0, 91, 10):
        lines.append(f'<text x="{across(v):.1f}" y="{top + height + 16}" text-anchor="middle">{v}</text>')
    lines.append(f'<line x1="{left}" x2="{left + width}" y1="{up(LIMIT_MM):.1f}" y2="{up(LIMIT_MM):.1f}" stroke="#c00" '
                 'stroke-dasharray="6 4"/>')
    colours = {"path": "#1764ab", "joints": "#e08214"}
    for index, (name, colour) in enumerate(colours.items()):
        for mark, _, _ in JOBS:
            shift = -1.5 + 3.0 * index
            for run in (r for r in runs if r.mark == mark and name in r.values):
                value, u = run.values[name]
                x = across(run.speed) + shift
                fill = colour if mark == JOBS[0][0] else "#fff"
                lines.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{up(value - u):.1f}" y2="{up(value + u):.1f}" '
                             f'stroke="{colour}"/>')
                lines.append(f'<circle cx="{x:.1f}" cy="{up(value):.1f}" r="3" fill="{fill}" stroke="{colour}"/>')
    for run in runs:
        if run.verdict in ("FAIL", "INVALID", "NOT PROVEN", "not planned"):
            sign = {"FAIL": "F", "INVALID": "I", "NOT PROVEN": "?", "not planned": "|"}[run.verdict]
            lines.append(f'<text x="{across(run.speed):.1f}" y="{top + 14 + (0 if run.mark == JOBS[0][0] else 14)}" '
                         f'text-anchor="middle" fill="#c00">{sign}</text>')


def plot_of(runs):
    lines = ['<svg xmlns="http://www.w3.org/2000/svg" width="690" height="600" font-family="sans-serif" font-size="12">',
             '<rect width="690" height="600" fill="#fff"/>']
    for index, (way, (title, _)) in enumerate(WAYS.items()):
        panel(lines, [run for run in runs if run.way == way], 30 + 280 * index, f"Geared steppers, {title}")
    lines.append('<text x="360" y="582" text-anchor="middle">speed of the belt, mm/s; value and U in mm: blue path, orange '
                 'joints</text>')
    lines.append('<text x="360" y="597" text-anchor="middle">full: marks at 60 mm/s, hollow: at 150 mm/s; ? not proven, F '
                 'fails, | is not planned: the unit leaves the field</text>')
    return "\n".join(lines + ["</svg>"]) + "\n"


def table_of(runs):
    lines = ["| marks | belt | verdict | " + " | ".join(CHECKS) + " | what is not proven |", "|---|---|---|" + "---|" * (len(CHECKS) + 1)]
    for run in runs:
        cells = [f"{run.values[c][0]:.4f} ± {run.values[c][1]:.4f}" if c in run.values else "" for c in CHECKS]
        lines.append(f"| {run.mark:g} mm/s | {run.speed:g} mm/s | {run.verdict} | " + " | ".join(cells) + " | " +
                     (run.reason or ", ".join(run.unproven)) + " |")
    return lines


def within(run):
    """Whether path and joints are proven within the limit, whatever the other checks say."""
    return all(sum(run.values.get(name, (LIMIT_MM, LIMIT_MM))) <= LIMIT_MM for name in ("path", "joints"))


def held(runs, mark, good):
    """Least and highest speed of those without a gap up to the highest that can be planned at which all is good as shipped."""
    speeds = []
    for run in [r for r in runs if r.way == "shipped" and r.mark == mark and r.speed > 0 and r.verdict != "not planned"][::-1]:
        if not good(run):
            break
        speeds.append(run.speed)
    return (speeds[-1], speeds[0]) if speeds else None


def page_of(runs, line):
    text = ["<!-- SPDX-License-Identifier: Apache-2.0 -->", "# Up to which speed of the belt geared steppers hold", "",
            line, "",
            f"The plate of [geared/plate.yaml](../../{SCENARIO}), 40 × 40 mm with seven corners, on",
            f"[two-mirror-geared](../../{MACHINE}), native build, fast twin. `path` and `joints` are what the kerf camera sees,",
            "`stillness_x` and `stillness_peak` what the spot camera sees; their limit is 0.05 mm, and a PASS takes value + U",
            "within it. [069](decisions/069-steps-for-the-rotor.md) says what the planner does for the rotors.", "",
            f"![Values of path and joints with their U over the speed of the belt]({PLOT})", ""]
    for mark, acceleration, _ in JOBS:
        span = held(runs, mark, lambda run: run.verdict == "PASS")
        cut = held(runs, mark, within)
        rest = [r for r in runs if r.way == "shipped" and r.mark == mark and r.speed == 0]
        text.append(f"- Marks at {mark:g} mm/s and {acceleration:g} mm/s²: at rest {rest[0].verdict}; on a belt " +
                    (f"path and joints within the limit at each speed tried from {cut[0]:g} to {cut[1]:g} mm/s" if cut else "none within the limit") +
                    (f", all checks PASS from {span[0]:g} to {span[1]:g} mm/s." if span else ", and not all checks PASS at the highest."))
    for way, (title, _) in WAYS.items():
        text += ["", f"## {title[0].upper()}{title[1:]}", ""] + table_of([run for run in runs if run.way == way])
    return "\n".join(text) + "\n"


def main():
    parser = argparse.ArgumentParser(prog="bench belt-speeds", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, help="folder of the build")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--out", default=os.path.join(ROOT, "docs", "explanation"), help="folder of page and plot")
    parser.add_argument("--quick", action="store_true", help="two speeds, nothing is written")
    try:
        options = parser.parse_args()
    except SystemExit as end:
        return 64 if end.code else 0
    line = stamp.line_of("belt-speeds", f"seed {SEED}")
    runs = runs_of(options.quick)
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for run in pool.map(lambda r: r.go(options.build, folder), runs):
            print(f"{run.name:16} {run.verdict:11} " + ", ".join(run.unproven) + run.reason, flush=True)
    if options.quick:
        return 0 if [run.verdict for run in runs] == ["PASS", "not planned"] else 1
    write(os.path.join(options.out, PLOT), plot_of(runs))
    write(os.path.join(options.out, PAGE), page_of(runs, line))
    spans = [held(runs, mark, lambda run: run.verdict == "PASS") for mark, _, _ in JOBS]
    return 0 if all(spans) else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (Broken, OSError) as error:
        print(f"belt-speeds: {error}", file=sys.stderr)
        sys.exit(2)
