# SPDX-License-Identifier: Apache-2.0
"""Kinds of faults with a known size: what is done to program, machine file, scenario or recorded pins, never to a measurement.

A fault's size is a multiple of the limit that it breaks. `cause` is the key of the diagnosis that is right, `size` what it must
measure, in the diagnosis's own unit; None where it has none.
"""
import bisect
import collections
import math

from jobs import FARTHEST_X, GANTRY, HEAD, Place
from drawing import ACROSS, ASKEW, CREASE, MIDDLE, marks
from job import EDGES, ENERGY, Job, energy_of, width
from by_gcode import cut_again, turned
from by_pins import insert, move_edge

PATH_MM, GATE_MS = 0.05, 0.5
REACH_X, REACH_Y = 25.0, 15.0  # Half of the drawing's size.

Fault = collections.namedtuple("Fault", "job cause size edits", defaults=((),))
Kind = collections.namedtuple("Kind", "name places make sized")
KINDS = []
EVERYWHERE = [Place(m, b) for m in (HEAD, GANTRY) for b in ("rest", "even")]
RESTING = [Place(m, "rest") for m in (HEAD, GANTRY)]
MOVING = [Place(m, b) for m in (HEAD, GANTRY) for b in ("even", "varies")]
VARYING = [Place(m, "varies") for m in (HEAD, GANTRY)]
ON_HEAD = [Place(HEAD, b) for b in ("rest", "even")]
ON_GANTRY = [Place(GANTRY, b) for b in ("rest", "even")]


def kind(places, sized=True):
    """A function (place, size over limit, random numbers) -> Fault becomes a kind of its name."""
    def add(make):
        KINDS.append(Kind(make.__name__, places, make, sized))
        return make
    return add


def sign(rng):
    return rng.choice((-1, 1))


def moved(place, move, **others):
    return place.job([mark.moved(move) for mark in marks()], **others)


# The program.

@kind(EVERYWHERE)
def program_offset(place, f, rng):
    angle, s = rng.uniform(0.0, 2.0 * math.pi), f * PATH_MM
    # A line sees its own normal alone: the farthest of the sides is off by the larger component.
    s /= max(abs(math.cos(angle)), abs(math.sin(angle)))
    dx, dy = s * math.cos(angle), s * math.sin(angle)
    return Fault(moved(place, lambda p: (p[0] + dx, p[1] + dy)), "program_offset", s)


@kind(EVERYWHERE)
def program_rotation(place, f, rng):
    s = sign(rng) * f * PATH_MM
    return Fault(place.job(turned(s).marks), "program_rotation", 1e3 * math.asin(s / 24.6))


@kind(EVERYWHERE)
def program_scale(place, f, rng):
    scale = 1.0 + sign(rng) * f * PATH_MM / REACH_X
    of = [m.moved(lambda p: tuple(c + scale * (q - c) for q, c in zip(p, MIDDLE)), scale) for m in marks()]
    return Fault(place.job(of), "program_scale", 100.0 * (scale - 1.0))


@kind(EVERYWHERE)
def program_scale_x(place, f, rng):
    scale = 1.0 + sign(rng) * f * PATH_MM / REACH_X
    return Fault(moved(place, lambda p: (MIDDLE[0] + scale * (p[0] - MIDDLE[0]), p[1])), "program_scale_x",
                 100.0 * (scale - 1.0))


@kind(EVERYWHERE)
def program_shear(place, f, rng):
    shear = sign(rng) * f * PATH_MM / REACH_Y
    return Fault(moved(place, lambda p: (p[0] + shear * (p[1] - MIDDLE[1]), p[1])), "program_shear", 1e3 * shear)


@kind(EVERYWHERE, sized=False)
def entity_missing(place, f, rng):
    gone = rng.choice((4, 5, 6, 7))
    return Fault(place.job([m for m in marks() if m.entity != gone]), "entity_missing", None)


@kind(EVERYWHERE, sized=False)
def entity_twice(place, f, rng):
    return Fault(place.job(cut_again(2.0).marks), "entity_twice", None)


# What the release was told of its machine.

def told(place, what, **others):
    return place.job(machine=f"controller: {{{what}}}\n", **others)


@kind(RESTING)
def step_scale(place, f, rng):
    share = sign(rng) * f * PATH_MM / FARTHEST_X[place.machine]
    key, right = ("mirror_step_urad", 12.5) if place.machine == HEAD else ("gantry_step_mm", 0.0125)
    return Fault(told(place, f"{key}: {right / (1.0 + share):.12g}"), "step_scale", 100.0 * share)


@kind([Place(HEAD, "rest")])
def throw(place, f, rng):
    share = sign(rng) * f * PATH_MM / REACH_X
    return Fault(told(place, f"throw_mm: {500.0 / (1.0 + share):.6f}"), "head_scale", 100.0 * share)


@kind([Place(HEAD, "rest")])
def spacing(place, f, rng):
    share = sign(rng) * f * PATH_MM / REACH_X
    return Fault(told(place, f"mirror_spacing_mm: {515.0 / (1.0 + share) - 500.0:.6f}"), "head_scale_x", 100.0 * share)


@kind(ON_HEAD)
def pincushion_missing(place, f, rng):
    return Fault(place.job(keys="planner: {faults: {no_pincushion: true}}\n"), "pincushion_missing", 100.0)


def table(of):
    rows = [f"{x},{y},{of(x, y)[0]:.9f},{of(x, y)[1]:.9f}" for y in range(-90, 91, 15) for x in range(-80, 81, 20)]
    return {"table.csv": "x_mm,y_mm,dx_mm,dy_mm\n" + "\n".join(rows) + "\n"}


def with_table(place, share, fault):
    """Mirrors that turn too far along x and not far enough along y, and a table that mends it, of which the release applies
    the share `fault`."""
    b = -0.7 * share
    optics = f"optics: {{mirror_x: {{scale: {1.0 + share:.9f}}}, mirror_y: {{scale: {1.0 + b:.9f}}}}}\n"
    has_it = optics + "controller: {correction: table.csv}\n"
    job = place.job(machine=has_it, edit=lambda recording: None, foreign=False,
                    files=table(lambda x, y: (-share * x, -b * y)))
    applied = {**job.files, **table(lambda x, y: (-fault * share * x, -fault * b * y))}
    job.recorded_with = (has_it if fault else optics, applied)
    return job


@kind([Place(HEAD, "rest")])
def table_missing(place, f, rng):
    return Fault(with_table(place, f * PATH_MM / REACH_X, 0), "table_missing", 100.0)


@kind([Place(HEAD, "rest")])
def table_sign(place, f, rng):
    return Fault(with_table(place, 0.5 * f * PATH_MM / REACH_X, -1), "table_sign", 200.0)


@kind([Place(HEAD, "rest")])
def table_other(place, f, rng):
    s = f * PATH_MM
    a, b = sign(rng), sign(rng)
    files = table(lambda x, y: (a * s * (x / REACH_X) ** 2 + b * s * x * y / REACH_X / REACH_Y,
                                b * s * (x / REACH_X) ** 2 - a * s * (y / REACH_Y) ** 2 * 0.5))
    return Fault(told(place, "correction: table.csv", files=files), "table_other", 100.0)


@kind(MOVING)
def sheet_reference(place, f, rng):
    s = sign(rng) * f * PATH_MM
    return Fault(told(place, f"print_mark_sensor_x_mm: {-150.0 + s:.6f}"), "sheet_reference", s)


@kind(MOVING)
def encoder_scale(place, f, rng):
    # The sheet has travelled 110 to 200 mm since its mark when it is cut.
    share = sign(rng) * f * PATH_MM / 170.0
    return Fault(told(place, f"encoder_count_mm: {0.01 * (1.0 + share):.12f}"), "encoder_scale", 100.0 * share)


@kind(MOVING, sized=False)
def encoder_reversed(place, f, rng):
    return Fault(place.job(machine="pins: {encoder_a: PD1, encoder_b: PD2}\n"), "encoder_reversed", None)


@kind([Place(m, "drifts") for m in (HEAD, GANTRY)])
def mean_speed(place, f, rng):
    return Fault(place.job(keys="planner: {faults: {mean_speed: true}}\n"), "mean_speed", 100.0)


@kind(MOVING)
def belt_ignored(place, f, rng):
    return Fault(place.job(keys="planner: {faults: {ignore_belt: true}}\n"), "belt_ignored", 100.0)


# The machine.

@kind(ON_HEAD)
def head_offset(place, f, rng):
    angle, s = rng.uniform(0.0, 2.0 * math.pi), f * PATH_MM
    s /= max(abs(math.cos(angle)), abs(math.sin(angle)))
    x, y = 1e6 * s * math.cos(angle) / 2.0 / 515.0, 1e6 * s * math.sin(angle) / 2.0 / 500.0
    return Fault(place.job(machine=f"optics: {{mirror_x: {{zero_urad: {x:.3f}}}, mirror_y: {{zero_urad: {y:.3f}}}}}\n"),
                 "head_offset", s)


@kind(ON_GANTRY)
def head_shear(place, f, rng):
    shear = sign(rng) * min(f, 2.9) * PATH_MM / REACH_Y
    return Fault(place.job(machine=f"squareness_urad: {1e6 * shear:.3f}\n"), "head_shear", 1e3 * shear)


@kind(ON_GANTRY)
def backlash(place, f, rng):
    axis, play = rng.choice("xy"), 2.0 * f * PATH_MM
    return Fault(place.job(machine=f"gantry_{axis}: {{backlash_mm: {play:.6f}}}\n"), f"backlash_{axis}", play)


@kind(ON_GANTRY, sized=False)
def loop_soft(place, f, rng):
    """A job that asks for more acceleration than frame and loops bear: hooks at starts and corners."""
    job = place.job()
    job.keys = job.keys.replace("acceleration_mm_s2: 500", f"acceleration_mm_s2: {2500 * f:.0f}")
    return Fault(job, "loop_soft", None)


@kind(ON_HEAD)
def axes_lag(place, f, rng):
    late_s = 1e-3 * f * GATE_MS
    hz = 1.4 / (2.0 * math.pi) / (1.4 / (2.0 * math.pi * 1200.0) + late_s)
    servo = f"{{servo: {{bandwidth_hz: {hz:.6f}}}}}"
    return Fault(place.job(machine=f"galvo_x: {servo}\ngalvo_y: {servo}\n"), "axes_lag", 1e3 * late_s)


@kind([Place(HEAD, "plate")], sized=False)
def stepper_pulled_out(place, f, rng):
    """A motor with too little torque for its job."""
    axis, torque = rng.choice("xy"), 0.02 / (1.0 + f)
    return Fault(Job(base="geared/plate.yaml",
                     keys="planner: {acceleration_mm_s2: 20000, mark_speed_mm_s: 60, jump_speed_mm_s: 400}\n",
                     machine=f"galvo_{axis}: {{stepper: {{holding_torque_n_m: {torque:.5f}, detent_torque_n_m: 0.0005}}}}\n"),
                 "stepper_pulled_out", None)


# Recorded pins.

def recorded(place, change, foreign=True, **others):
    return place.job(edit=change, foreign=foreign, **others)


def outputs(place):
    return tuple(f"{place.axes}_{a}_{w}" for a in "xy" for w in ("pul", "dir")) + ("laser_gate", "laser_pwm")


@kind(VARYING)
def latency(place, f, rng):
    late_s = f * PATH_MM / (0.85 * place.speed)

    def change(recording):
        late = recording.ticks(late_s)
        for wire in outputs(place):
            recording.wires[wire] = [(tick + late, level) for tick, level in recording.wires[wire]]
    return Fault(recorded(place, change, foreign=False), "latency", 1e3 * late_s)


@kind(RESTING, sized=False)
def axis_reversed(place, f, rng):
    axis = rng.choice("xy")

    def change(recording):
        wire = f"{place.axes}_{axis}_dir"
        recording.wires[wire] = [(1, 1)] + [(tick, 1 - level) for tick, level in recording.wires[wire] if tick > 1]
    return Fault(recorded(place, change), "axes", None)


@kind(RESTING, sized=False)
def axes_swapped(place, f, rng):
    def change(recording):
        for what in ("pul", "dir"):
            x, y = f"{place.axes}_x_{what}", f"{place.axes}_y_{what}"
            recording.wires[x], recording.wires[y] = recording.wires[y], recording.wires[x]
    return Fault(recorded(place, change), "axes", None)


def gate_moved(place, ms):
    def change(recording):
        for opens, _ in recording.spans("laser_gate"):
            move_edge(recording, "laser_gate", opens, opens + recording.ticks(1e-3 * ms))
    return recorded(place, change, foreign=False)


# The gantry speeds up so slowly that half a millisecond moves nothing that anybody would see.
@kind([Place(HEAD, b) for b in ("rest", "even")])
def gate_late(place, f, rng):
    return Fault(gate_moved(place, f * GATE_MS), "gate_late", f * GATE_MS)


@kind([Place(HEAD, b) for b in ("rest", "even")])
def gate_early(place, f, rng):
    return Fault(gate_moved(place, -f * GATE_MS), "gate_early", f * GATE_MS)


@kind(ON_HEAD + ON_GANTRY)
def dir_timing(place, f, rng):
    axis, before_us = rng.choice("xy"), 5.0 / (1.0 + f)

    def change(recording):
        pulses = [rise for rise, _ in recording.spans(f"{place.axes}_{axis}_pul")]
        wire = f"{place.axes}_{axis}_dir"
        edges = []
        for tick, level in recording.wires[wire]:
            after = bisect.bisect_left(pulses, tick)
            late = pulses[after] - recording.ticks(1e-6 * before_us) if after < len(pulses) else tick
            edges.append((max(tick, late), level))
        recording.wires[wire] = [e for i, e in enumerate(edges) if i + 1 == len(edges) or e[0] < edges[i + 1][0]]
    return Fault(recorded(place, change, foreign=False), "dir_timing", before_us)


def pulses_between(recording, place, axis, share):
    """Pulses in the gap between two cuts, those of the more common sense, each with room behind it."""
    spans = recording.spans("laser_gate")
    at = 1 + int(share * (len(spans) - 2))
    gaps = sorted(range(1, len(spans)), key=lambda i: abs(i - at))
    for i in gaps:
        begins, ends = spans[i - 1][1], spans[i][0]
        pulses = recording.spans(f"{place.axes}_{axis}_pul")
        inside = [(p, after[0]) for p, after in zip(pulses, pulses[1:]) if begins < p[0] and after[0] < ends]
        if len(inside) < 60:
            continue
        wire = f"{place.axes}_{axis}_dir"
        sense = recording.level(wire, inside[len(inside) // 2][0][0])
        found = [p for p, after in inside if after - p[0] > recording.ticks(40e-6)
                 and recording.level(wire, p[0]) == sense == recording.level(wire, after)]
        if len(found) >= 40:
            return found
    raise AssertionError("no jump has pulses enough")


def steps_of(place, f, axis):
    return round(f * PATH_MM / place.step_mm(axis)) + 1


@kind(EVERYWHERE)
def pulses_lost(place, f, rng):
    axis, share = rng.choice("xy"), rng.random()
    count = min(40, steps_of(place, f, axis))

    def change(recording):
        gone = {tick for pulse in pulses_between(recording, place, axis, share)[:count] for tick in pulse}
        wire = f"{place.axes}_{axis}_pul"
        recording.wires[wire] = [edge for edge in recording.wires[wire] if edge[0] not in gone]
    return Fault(recorded(place, change), "pulses_lost", count)


@kind(EVERYWHERE)
def pulses_doubled(place, f, rng):
    axis, share = rng.choice("xy"), rng.random()
    count = min(40, steps_of(place, f, axis))

    def change(recording):
        late = recording.ticks(20e-6)
        twice = pulses_between(recording, place, axis, share)[:count]
        insert(recording, f"{place.axes}_{axis}_pul",
               [edge for rise, fall in twice for edge in ((rise + late, 1), (fall + late, 0))])
    return Fault(recorded(place, change), "pulses_doubled", count)


@kind(EVERYWHERE)
def pulses_lost_under_load(place, f, rng):
    """One here and one there, all of one sense, and the controller's own words count them."""
    axis, sense, seed = rng.choice("xy"), rng.choice((0, 1)), rng.random()
    count = steps_of(place, 1.5 * f, axis)

    def change(recording):
        wire, way = f"{place.axes}_{axis}_pul", f"{place.axes}_{axis}_dir"
        pulses = [p for p in recording.spans(wire) if recording.level(way, p[0]) == sense]
        stride = len(pulses) / (count + 1.0)
        gone = {tick for i in range(count) for tick in pulses[int((i + 0.2 + 0.6 * seed) * stride)]}
        recording.wires[wire] = [edge for edge in recording.wires[wire] if edge[0] not in gone]
    return Fault(recorded(place, change, foreign=False), "pulses_lost", count)


# The laser.

@kind(EVERYWHERE)
def power_scale(place, f, rng):
    energy = energy_of(width(ENERGY) + min(f, 2.0) * 0.02)
    share = energy / ENERGY - 1.0
    job = told(place, f"full_power_w: {100.0 / (1.0 + share):.6f}",
               keys=f"checks: {{ordered_width: {{nominal_mm: {width(ENERGY):.6f}, limit_mm: 0.02}}}}\n")
    return Fault(job, "power_scale", 100.0 * share)


@kind([Place(HEAD, "contour")], sized=False)
def power_loop_rings(place, f, rng):
    """The paper's gain of 1 behind a meter that tells late."""
    speed = rng.uniform(80.0, 110.0)
    return Fault(Job(base="native/short-lines.yaml", keys=f"planner: {{mark_speed_mm_s: {speed:.2f}, power: {{law: paper}}}}\n"),
                 "power_loop_rings", None)


@kind(EVERYWHERE, sized=False)
def gate_inverted(place, f, rng):
    return Fault(place.job(machine="laser: {gate_low: true}\n"), "gate_inverted", None)


# The kerf beside the line.

def edges(keys):
    return Job(keys="print: {units: 1}\n" + keys, base=EDGES)


@kind([Place(HEAD, "label")])
def kerf_uncompensated(place, f, rng):
    return Fault(edges("planner: {kerf_radius_mm: 0}\n"), "kerf_uncompensated", 0.0508)


@kind([Place(HEAD, "label")])
def kerf_wrong_side(place, f, rng):
    radius = 0.051 + 0.002 * f
    return Fault(edges(f"planner: {{kerf_radius_mm: {radius:.4f}, faults: {{kerf_wrong_side: true}}}}\n"), "kerf_wrong_side",
                 radius + 0.0508)


@kind([Place(HEAD, "label")])
def kerf_radius(place, f, rng):
    s = f * PATH_MM
    return Fault(edges(f"planner: {{kerf_radius_mm: {0.0508 + s:.6f}}}\n"), "kerf_radius", s)
