# SPDX-License-Identifier: Apache-2.0
"""What one run of a fault is made of, and the figures of the shipped machine that sizes are computed with."""
import math

LABEL, EDGES = "native/label-on-belt.yaml", "native/label-edges.yaml"
STRIP, STOP_AND_GO, SHORT_LINES = (
    "native/strip-crosscut.yaml", "native/strip-stop-and-go.yaml", "native/short-lines.yaml")
INTERLOCK = "safe/native/interlock.yaml"

# The job of drawing.py on a web, and on a sheet that rests with its middle under the resting beam.
BELT_MM_S = 30.0
MOVING, RESTING = f"belt: {{speed_mm_s: {BELT_MM_S}}}\n", "belt: {speed_mm_s: 0, start_x_mm: 25}\n"

# The scenario's speed and acceleration of marks and of jumps, and the laser's power.
MARK_MM_S, JUMP_MM_S, ACCELERATION_MM_S2, FULL_POWER_W = 300.0, 450.0, 20000.0, 100.0
# The head: throw, distance of its mirrors, and the optical angle of a step.
THROW_MM, SPACING_MM, STEP_RAD = 500.0, 15.0, 2 * 12.5e-6
STEP_X_MM, STEP_Y_MM = (THROW_MM + SPACING_MM) * STEP_RAD, THROW_MM * STEP_RAD

# The shipped laser and board: 1/e^2 radius, energy, fluence that severs, light through whole board.
BEAM_MM, ENERGY, SEVERS, TRANSMISSION = 0.105, 0.105, 0.5, 0.12
# A kerf is as wide as half of the light comes through: ln of the fluence for that over the one that severs.
HALF_LIGHT = -math.log(1.0 - math.log(0.5 * (1.0 + TRANSMISSION)) / math.log(TRANSMISSION))


def peak(energy):
    """Fluence in the middle of a cut over the one that severs."""
    return math.sqrt(2.0 / math.pi) * energy / BEAM_MM / SEVERS


def width(energy):
    return 2.0 * BEAM_MM * math.sqrt(0.5 * (math.log(peak(energy)) + HALF_LIGHT))


def energy_of(width_mm):
    """The energy that makes a cut so wide."""
    return ENERGY * math.exp(2.0 * (0.5 * width_mm / BEAM_MM) ** 2 - HALF_LIGHT) / peak(ENERGY)


class Job:
    """A scenario with a fault.

    marks: G-code in place of the scenario's own drawing, on `belt`. keys: lines of the scenario, a section each.
    machine: sections of a machine file. files: other files by name. edit: changes the recording of the flawless
    run, which is then replayed. beside: another job, whose recording `edit` gets as well. foreign: the recording is
    one of another program, without the controller's words.
    """

    def __init__(self, marks=None, keys="", machine="", base=LABEL, belt=MOVING, files=None, edit=None, beside=None,
                 foreign=False):
        self.marks, self.keys, self.machine, self.base, self.belt = marks, keys, machine, base, belt
        self.files, self.edit, self.beside, self.foreign = files or {}, edit, beside, foreign
