# SPDX-License-Identifier: Apache-2.0
"""Runs to diagnose: the drawing of tests/limits on both machines, with a fault of a known size or without."""
import os
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path.append(os.path.join(ROOT, "tests", "limits"))
from drawing import gcode, marks  # noqa: E402
from job import Job  # noqa: E402

HEAD, GANTRY = "head", "gantry"
BASE = {HEAD: "native/label-on-belt.yaml", GANTRY: "native/strip-crosscut.yaml"}
AXES = {HEAD: "galvo", GANTRY: "gantry"}
MACHINE_OF_STEP_MM = {HEAD: {"x": 515 * 2 * 12.5e-6, "y": 500 * 2 * 12.5e-6}, GANTRY: {"x": 0.0125, "y": 0.0125}}
SPEED = {HEAD: 30.0, GANTRY: 30.0}
# Places of the sheet's origin at rest: the drawing in the middle of the head's field; the gantry's begins there.
REST_X = {HEAD: 25.0, GANTRY: 100.0}
FARTHEST_X = {HEAD: 25.0, GANTRY: 100.0}  # Of the drawing from the origin of W.
GANTRY_KEYS = ("print: {pitch_mm: 400, eye_mark_x_mm: 4, eye_mark_length_mm: 4, marks: ["
               + ", ".join("{x_mm: %d, y_mm: %d, diameter_mm: 4}" % p
                           for p in ((-55, -27), (-55, 27), (-5, -27), (-5, 27), (-20, 27))) + "]}\n"
               "planner: {mark_speed_mm_s: 60, jump_speed_mm_s: 100, acceleration_mm_s2: 500, alternate: false}\n")


class Place:
    """Where and how a job is cut: the machine, and what its sheet does."""

    def __init__(self, machine, belt):
        self.machine, self.belt = machine, belt

    def __str__(self):
        return f"{self.machine}-{self.belt}"

    @property
    def moves(self):
        return self.belt != "rest"

    @property
    def speed(self):
        return SPEED[self.machine]

    @property
    def axes(self):
        return AXES[self.machine]

    def step_mm(self, axis):
        return MACHINE_OF_STEP_MM[self.machine][axis]

    def belt_keys(self):
        if self.belt == "rest":
            return f"belt: {{speed_mm_s: 0, start_x_mm: {REST_X[self.machine]:g}}}\n"
        if self.belt == "even":
            return f"belt: {{speed_mm_s: {self.speed:g}}}\n"
        # Slower within the first unit and faster again within the second.
        low = (0.98 if self.belt == "drifts" else 0.75) * self.speed
        at = (4.6, 5.4, 8.2, 9.0) if self.machine == HEAD else (16.0, 17.5, 20.0, 21.5)
        points = ", ".join(f"{{at_s: {t:g}, speed_mm_s: {v:g}}}" for t, v in zip(at, (self.speed, low, low, self.speed)))
        return f"belt: {{speed_mm_s: {self.speed:g}, profile: [{points}]}}\n"

    def job(self, of=None, keys="", machine="", **others):
        """A Job here; `of`: another drawing's marks than the flawless ones."""
        units = 2 if self.belt in ("varies", "drifts") and self.machine == HEAD else 1
        own = f"print: {{units: {units}}}\n" + (GANTRY_KEYS if self.machine == GANTRY else "")
        of = marks() if of is None else of
        files = {"job.gcode": gcode_of(of), **others.pop("files", {})}
        return Job(of, own + keys, machine=machine, base=BASE[self.machine], files=files,
                   belt=self.belt_keys(), **others)


def gcode_of(job):
    """As drawing.gcode(), with the name of its own side for each piece of the outline."""
    text = gcode([mark for mark in job])
    lines, side = [], 0
    for line in text.splitlines():
        if line.startswith("G00"):
            side = 0
        elif line.startswith("G01") and line.endswith("(E0)"):
            line = line[:-4] + f"(E{side})"
            side += 1
        lines.append(line)
    return "\n".join(lines) + "\n"
