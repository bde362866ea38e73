# SPDX-License-Identifier: Apache-2.0
"""Faults in what a release sends: the recording of a flawless run, edited and replayed.

A mark is named by its place in the job; the gate opens once for each.
"""
import bisect
import itertools
import math

from drawing import ACROSS, ASKEW, OUTLINE, marks
from job import (ACCELERATION_MM_S2, BELT_MM_S, ENERGY, FULL_POWER_W, INTERLOCK, JUMP_MM_S, MARK_MM_S, RESTING,
                 STEP_X_MM, STEP_Y_MM, Job)

PERIOD_S = 0.8e-3  # The controller prepares so much at a time.
OUTPUTS = ("galvo_x_pul", "galvo_x_dir", "galvo_y_pul", "galvo_y_dir", "laser_gate", "laser_pwm")


def place_of(entity):
    """Place in the job of the first mark of an entity."""
    return next(i for i, mark in enumerate(marks()) if mark.entity == entity)


def edited(change, keys="", **others):
    return Job(marks(), keys, edit=change, **others)


def gate(recording, entity):
    return recording.spans("laser_gate")[place_of(entity)]


def move_edge(recording, wire, tick, to):
    """Moves the edge of a wire, which may pass none of its neighbours."""
    edges = recording.wires[wire]
    at = bisect.bisect_left(edges, (tick, 0))
    assert edges[at][0] == tick, "no edge there"
    assert (at == 0 or edges[at - 1][0] < to) and (at + 1 == len(edges) or to < edges[at + 1][0]), "passes an edge"
    edges[at] = (to, edges[at][1])


def insert(recording, wire, edges):
    recording.wires[wire] = sorted(recording.wires[wire] + edges)


# The laser's gate.

def gate_opens_late(ms, keys=""):
    """All openings are late, or early where the time is negative."""
    def change(recording):
        for opens, _ in recording.spans("laser_gate"):
            move_edge(recording, "laser_gate", opens, opens + recording.ticks(1e-3 * ms))
    return edited(change, keys)


# Ends that are not burnt are ends that lie elsewhere, and starts that are late.
ENDS_ASIDE = "checks: {path_mm: 0.5, gate_lag_ms: 100}\n"


def ramp_s(way_mm):
    """Time of the first or of the last piece of a mark, from or to rest."""
    return math.sqrt(2.0 * way_mm / ACCELERATION_MM_S2)


def start_unburnt(size_mm):
    def change(recording):
        opens, _ = gate(recording, ASKEW)
        move_edge(recording, "laser_gate", opens, opens + recording.ticks(ramp_s(size_mm)))
    return edited(change, ENDS_ASIDE)


def end_unburnt(size_mm):
    def change(recording):
        _, closes = gate(recording, ASKEW)
        move_edge(recording, "laser_gate", closes, closes - recording.ticks(ramp_s(size_mm)))
    return edited(change, ENDS_ASIDE)


def dimmed(recording, begins, ends, share):
    """Edges of a PWM of 50 kHz, much faster than the laser follows."""
    period = recording.ticks(20e-6)
    lit = round(share * period)
    return [edge for tick in range(begins, ends - period, period) for edge in ((tick, 1), (tick + lit, 0))]


def lit_in_jump(size_mm):
    """The gate opens in the middle of a jump, at its full speed, with as much light per length as a cut's."""
    way_mm = max(0.05, size_mm - 0.13)  # A kerf is longer than the beam's way by its width, less what its ends lose.

    def change(recording):
        middle = (gate(recording, ACROSS)[1] + gate(recording, ASKEW)[0]) // 2
        light = recording.ticks(way_mm / JUMP_MM_S)
        opens = middle - light // 2
        insert(recording, "laser_gate", [(opens, 1), (opens + light, 0)])
        insert(recording, "laser_pwm", dimmed(recording, opens, opens + light, ENERGY * JUMP_MM_S / FULL_POWER_W))
    # The spot off every line fails spot_path, however short: that check is to say nothing here.
    return edited(change, "checks: {path_mm: 10}\n")


def rest_with_light(size_mm):
    """The controller waits for 10 ms at the end of a line, its laser on; the last 0.1 mm of the line lie there too."""
    power = (size_mm - 0.1) * ENERGY / 10e-3 / FULL_POWER_W

    def change(recording):
        _, closes = gate(recording, ASKEW)
        pause = recording.ticks(10e-3)
        for wire, edges in recording.wires.items():
            recording.wires[wire] = [(tick + pause if tick >= closes else tick, level) for tick, level in edges]
        recording.words = [(tick + pause if tick >= closes else tick, word) for tick, word in recording.words]
        recording.end += pause
        assert recording.level("laser_pwm", closes) == 0, "the laser has power at the end of the line"
        insert(recording, "laser_pwm", dimmed(recording, closes, closes + pause, power))
    return edited(change, "checks: {path_mm: 0.5}\n", belt=RESTING)


def light_after_gate(ms):
    """The laser is late behind its pins, and the release makes up for it: the cut is flawless."""
    def change(recording):
        early = recording.ticks(1e-3 * ms)
        for wire in ("laser_gate", "laser_pwm"):
            recording.wires[wire] = [(tick - early, level) for tick, level in recording.wires[wire]]
    return edited(change, "planner: {jump_radius_mm: 5}\nchecks: {gate_lag_ms: 100, path_mm: 0.5}\n",
                  machine=f"laser: {{gate_delay_us: {1e3 * ms:g}}}\n")


# Guard and safe states.

def guard_ignored(ms):
    """The guard opens within a cut, and the gate closes so much later."""
    def change(recording):
        _, closes = gate(recording, ASKEW)
        insert(recording, "interlock", [(closes - recording.ticks(1e-3 * ms), 0), (closes + recording.ticks(5e-3), 1)])
    return edited(change)


def opened(recording):
    """Tick at which the provoked guard opens."""
    return recording.edges("interlock", 0)[0]


def lit_after_guard(ms):
    def change(recording):
        closes = recording.spans("laser_gate")[-1][1]
        move_edge(recording, "laser_gate", closes, opened(recording) + recording.ticks(1e-3 * ms))
    return Job(base=INTERLOCK, edit=change)


def step_after_guard(ms):
    """The last step of an axis is that late."""
    def change(recording):
        fall, rise = (recording.wires["galvo_x_pul"].pop()[0] for _ in range(2))
        late = opened(recording) + recording.ticks(1e-3 * ms)
        recording.wires["galvo_x_pul"] += [(late, 1), (late + fall - rise, 0)]
    return Job(base=INTERLOCK, edit=change)


def report_after_guard(ms):
    """The controller is silent until then. The sheet rests, so that what it says of the belt is still true."""
    def change(recording):
        guard = opened(recording)
        first = next(tick for tick, _ in recording.words if tick > guard)
        late = guard + recording.ticks(1e-3 * ms) - first
        recording.words = [(tick + late if tick >= first else tick, word) for tick, word in recording.words]
        assert recording.words[-1][0] < recording.end, "the recording ends before the word"
    return Job(base=INTERLOCK, keys="belt: {speed_mm_s: 0, start_x_mm: 27.5}\nprovoke: {interlock_open_at_s: 0.6}\n",
               edit=change)


def lit_after_queue(ms):
    """The queue runs dry: its last step is the last of Y, which follows no belt, that is as where the host sends on."""
    def change(recording, undisturbed):
        begins = recording.edges("laser_gate", 1)[0]
        assert begins == undisturbed.edges("laser_gate", 1)[0], "the runs do not begin alike"
        steps, more = ([t for t in run.edges("galvo_y_pul", 1) if t > begins] for run in (recording, undisturbed))
        last = [here for here, there in itertools.takewhile(lambda pair: pair[0] == pair[1], zip(steps, more))][-1]
        late = recording.ticks(PERIOD_S) + recording.ticks(1e-3 * ms)
        closes = recording.spans("laser_gate")[-1][1]
        move_edge(recording, "laser_gate", closes, last + late)
    return Job(keys="provoke: {host_starves_after_share: 0.6}\n", edit=change, beside=Job())


# Pulses and their direction.

def reversal(recording):
    """DIR of Y turns: the edge of DIR, the step before and the step after."""
    steps = recording.edges("galvo_y_pul", 1)
    for tick, _ in recording.wires["galvo_y_dir"]:
        at = bisect.bisect_left(steps, tick)
        if 0 < at < len(steps) and steps[at] - steps[at - 1] > recording.ticks(100e-6):
            return tick, steps[at - 1], steps[at]
    raise AssertionError("no reversal with time enough")


def short_set_up(us):
    def change(recording):
        tick, _, after = reversal(recording)
        move_edge(recording, "galvo_y_dir", tick, after - recording.ticks(1e-6 * us))
    return edited(change)


def short_hold(us):
    def change(recording):
        tick, before, _ = reversal(recording)
        move_edge(recording, "galvo_y_dir", tick, before + recording.ticks(1e-6 * us))
    return edited(change)


def short_pulse(us):
    def change(recording):
        rise, fall = recording.spans("galvo_y_pul")[1000]
        move_edge(recording, "galvo_y_pul", fall, rise + recording.ticks(1e-6 * us))
    return edited(change)


def short_pause(us):
    def change(recording):
        pulses = recording.spans("galvo_y_pul")
        move_edge(recording, "galvo_y_pul", pulses[1000][1], pulses[1001][0] - recording.ticks(1e-6 * us))
    return edited(change)


def pulses_of_jump(recording, axis):
    """Pulses of one direction in the jump to the outline, which is cut last, each with room for another behind it."""
    begins, ends = gate(recording, ASKEW)[1], gate(recording, OUTLINE)[0]
    pulses = recording.spans(f"galvo_{axis}_pul")
    inside = [(pulse, after[0]) for pulse, after in zip(pulses, pulses[1:]) if begins < pulse[0] and after[0] < ends]
    turned = recording.level(f"galvo_{axis}_dir", inside[len(inside) // 2][0][0])
    return [pulse for pulse, after in inside if after - pulse[0] > recording.ticks(40e-6)
            and recording.level(f"galvo_{axis}_dir", pulse[0]) == turned == recording.level(f"galvo_{axis}_dir", after)]


STEPS_MM = {"x": STEP_X_MM, "y": STEP_Y_MM}
STEPS = 10  # Displacement that is allowed, in steps: 11, 15 and 20 are faults, and 8 are none.


def wide_path(axis):
    # A line that lies farther on seems to begin sooner.
    return f"checks: {{path_mm: {STEPS * STEPS_MM[axis]:.6f}, gate_lag_ms: 100}}\n"


def lost_steps(size_mm, axis):
    """Steps get lost between the controller's own counter and the drive; nothing is reported."""
    def change(recording):
        lost = pulses_of_jump(recording, axis)[:round(size_mm / STEPS_MM[axis])]
        gone = {tick for pulse in lost for tick in pulse}
        wire = f"galvo_{axis}_pul"
        recording.wires[wire] = [edge for edge in recording.wires[wire] if edge[0] not in gone]
    return edited(change, wide_path(axis), foreign=True)


def doubled_steps(size_mm, axis):
    def change(recording):
        twice = pulses_of_jump(recording, axis)[:round(size_mm / STEPS_MM[axis])]
        late = recording.ticks(20e-6)
        insert(recording, f"galvo_{axis}_pul",
               [edge for rise, fall in twice for edge in ((rise + late, 1), (fall + late, 0))])
    return edited(change, wide_path(axis), foreign=True)


def steps_unreported(count):
    """Steps get lost that the controller counts: too few to see on the sheet."""
    def change(recording):
        gone = {tick for pulse in pulses_of_jump(recording, "y")[:count] for tick in pulse}
        recording.wires["galvo_y_pul"] = [edge for edge in recording.wires["galvo_y_pul"] if edge[0] not in gone]
    return edited(change)


# Latency.

def acts_late(size_mm):
    """All that the release does is late, and the web is further by then."""
    def change(recording):
        late = recording.ticks(size_mm / BELT_MM_S)
        for wire in OUTPUTS:
            recording.wires[wire] = [(tick + late, level) for tick, level in recording.wires[wire]]
            # The encoder's edges end where the recording does.
            assert recording.wires[wire][-1][0] < recording.end, "the last edge is not in the recording any more"
    return edited(change)


def axis_late(size_mm):
    """The pulses of Y are late behind those of X: a circle becomes an ellipse, farthest off where it runs askew."""
    def change(recording):
        late = recording.ticks(size_mm / (0.5 * MARK_MM_S))
        for wire in ("galvo_y_pul", "galvo_y_dir"):
            recording.wires[wire] = [(tick + late, level) for tick, level in recording.wires[wire]]
    return edited(change)
