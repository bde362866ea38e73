# SPDX-License-Identifier: Apache-2.0
"""Faults whose size is known, as a multiple of the limit of the check that must find them.

Each fault takes the size, in the unit of its limit, and returns a Job: marks, keys of the scenario, the base scenario.
The sizes follow from geometry or from the beam's formula, never from what the bench measures.
"""
import math

from drawing import (ACROSS, ASKEW, CIRCLE, CREASE, CUT_MM, MIDDLE, OUTLINE, PERFORATION, Mark, along, aside, marks, plus)

LABEL, EDGES = "native/label-on-belt.yaml", "native/label-edges.yaml"

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
    def __init__(self, job=None, keys="", controller="", base=LABEL):
        self.job, self.keys, self.controller, self.base = job, keys, controller, base


def edited(entity, change):
    """The job with the marks of one entity changed."""
    job = []
    for mark in marks():
        job += change(mark) if mark.entity == entity else [mark]
    return Job(job)


def all_moved(move, scale=1.0):
    return Job([mark.moved(move, scale) for mark in marks()])


def turned(size_mm):
    # The ends of the long sides are 25 mm from the middle; corners take 0.4 mm of them.
    angle = math.asin(size_mm / 24.6)
    c, s = math.cos(angle), math.sin(angle)

    def move(p):
        x, y = p[0] - MIDDLE[0], p[1] - MIDDLE[1]
        return (MIDDLE[0] + c * x - s * y, MIDDLE[1] + s * x + c * y)
    return all_moved(move)


def scaled(size_mm):
    scale = 1.0 + size_mm / 25.0
    return all_moved(lambda p: tuple(m + scale * (q - m) for q, m in zip(p, MIDDLE)), scale)


def side_displaced(size_mm):
    def change(mark):
        return [Mark(OUTLINE, [(x + size_mm, y) if x == 0 else (x, y) for x, y in mark.points])]
    return edited(OUTLINE, change)


def bump(size_mm, entity=ASKEW):
    """A line bent to one side over its middle 6 mm."""
    def change(mark):
        a, b = mark.points
        length = math.dist(a, b)
        half = 3.0 / length
        middle = plus(along(a, b, 0.5), aside(a, b, size_mm))
        return [Mark(entity, [a, along(a, b, 0.5 - half), middle, along(a, b, 0.5 + half), b])]
    return edited(entity, change)


def corner_cut_off(size_mm):
    """The cut passes the corner at (-50, 15) at this distance."""
    leg = size_mm * math.sqrt(2.0)

    def change(mark):
        points = []
        for x, y in mark.points:
            points += [(x + leg, y), (x, y - leg)] if (x, y) == (-50, 15) else [(x, y)]
        return [Mark(OUTLINE, points)]
    return edited(OUTLINE, change)


def end_moved(size_mm, entity=ASKEW, at_start=False):
    """A line that begins or ends too late (> 0: too long)."""
    def change(mark):
        a, b = mark.points
        share = size_mm / math.dist(a, b)
        return [Mark(entity, [along(a, b, -share), b] if at_start else [a, along(a, b, 1.0 + share)])]
    return edited(entity, change)


def hole(size_mm, entity=ASKEW):
    """A bridge in the middle of a line."""
    def change(mark):
        a, b = mark.points
        half = 0.5 * size_mm / math.dist(a, b)
        return [Mark(entity, [a, along(a, b, 0.5 - half)]), Mark(entity, [along(a, b, 0.5 + half), b])]
    return edited(entity, change)


def crease_cut_through(size_mm):
    def change(mark):
        a, b = mark.points
        half = 0.5 * size_mm / math.dist(a, b)
        before, after = along(a, b, 0.5 - half), along(a, b, 0.5 + half)
        return [Mark(CREASE, [a, before], z=0.5), Mark(CREASE, [before, after]), Mark(CREASE, [after, b], z=0.5)]
    return edited(CREASE, change)


def stray(size_mm):
    """A cut where the drawing has nothing; its kerf is longer than the beam's way by its width, less what ends lose."""
    # The spot off every line fails spot_path, however short: that check is to say nothing here.
    return Job(marks() + [Mark(ASKEW, [(-34.0, -6.0), (-34.0, -6.0 + max(0.05, size_mm - 0.13))])],
               "checks: {path_mm: 10}\n")


def cut_again(passes):
    """A part of a line cut a second time, and a third."""
    def change(mark):
        a, b = mark.points
        again, rest = [], passes - 1.0
        while rest > 1e-9:
            again.append(Mark(ACROSS, [a, along(a, b, min(1.0, rest))]))
            rest -= 1.0
        return [mark] + again
    return edited(ACROSS, change)


def drift(size_mm):
    """A line across the belt that leans along x, evenly."""
    return edited(ACROSS, lambda mark: [Mark(ACROSS, [plus(mark.points[0], (-0.5 * size_mm, 0)),
                                                      plus(mark.points[1], (0.5 * size_mm, 0))])])


def bow(size_mm):
    """A line across the belt whose middle is aside; from its mean it strays by half of that, either way."""
    def change(mark):
        a, b = mark.points
        return [Mark(ACROSS, [a, plus(along(a, b, 0.5), (2.0 * size_mm, 0)), b])]
    job = edited(ACROSS, change)
    job.keys = "checks: {path_mm: 0.5}\n"  # Its middle is off the drawing by twice the size.
    return job


def long_dash(size_mm, number=2):
    def change_all(job):
        first = [i for i, mark in enumerate(job) if mark.entity == PERFORATION][number]
        a, b = job[first].points
        job[first] = Mark(PERFORATION, [a, (b[0], b[1] + size_mm)])
        return Job(job)
    return change_all(marks())


def shifted_pattern(size_mm):
    """All cuts of a perforation but the first and the last lie aside along it."""
    job = marks()
    own = [i for i, mark in enumerate(job) if mark.entity == PERFORATION][1:-1]
    for i in own:
        job[i] = job[i].moved(lambda p: (p[0], p[1] + size_mm))
    return Job(job)


def ordered_width(change_mm):
    energy = energy_of(width(ENERGY) + change_mm)
    job = edited(CREASE, lambda mark: [Mark(CREASE, mark.points, z=0.5 * ENERGY / energy)])  # As deep as ever.
    return Job(job.job, f"planner: {{cut_energy_j_per_mm: {energy:.6f}}}\n"
               f"checks: {{ordered_width: {{nominal_mm: {width(ENERGY):.6f}, limit_mm: 0.02}}}}\n")


def narrow_line(change_mm):
    """One line with less power than all others."""
    z = energy_of(width(ENERGY) - change_mm) / ENERGY
    job = edited(ASKEW, lambda mark: [Mark(ASKEW, mark.points, z=z)])
    job.keys = "checks: {kerf_width_mm: 0.02}\n"
    return job


def ordered_depth(change):
    """The crease is deeper or shallower than the middle of the order."""
    middle = 0.5 * peak(ENERGY)
    job = edited(CREASE, lambda mark: [Mark(CREASE, mark.points, z=(middle + change) / peak(ENERGY))])
    job.keys = f"checks: {{crease_depth: {{min: {middle - 0.1:.6f}, max: {middle + 0.1:.6f}}}}}\n"
    return job


def sensor_shifted(size_mm):
    """The controller is told another place of the print mark's sensor."""
    return Job(marks(), controller=f"controller: {{print_mark_sensor_x_mm: {-150.0 + size_mm:.6f}}}\n")


def kerf_radius(size_mm):
    """The kerf is compensated by too much."""
    return Job(None, f"planner: {{kerf_radius_mm: {0.0508 + size_mm:.6f}}}\n", base=EDGES)


# name, check that must fail, limit, unit, fault by its size, what it is.
FAULTS = [
    ("shift-x", "path", 0.05, "mm", lambda s: all_moved(lambda p: (p[0] + s, p[1])), "the job is displaced along x"),
    ("shift-x-back", "path", 0.05, "mm", lambda s: all_moved(lambda p: (p[0] - s, p[1])), "displaced against x"),
    ("shift-y", "path", 0.05, "mm", lambda s: all_moved(lambda p: (p[0], p[1] + s)), "displaced along y"),
    ("sensor", "path", 0.05, "mm", sensor_shifted, "another place of the print mark's sensor"),
    ("turned", "path", 0.05, "mm", turned, "turned about its middle; size at the farthest place"),
    ("turned-back", "path", 0.05, "mm", lambda s: turned(-s), "turned the other way"),
    ("scaled-up", "path", 0.05, "mm", scaled, "too large; size at the farthest place"),
    ("scaled-down", "path", 0.05, "mm", lambda s: scaled(-s), "too small"),
    ("side", "path", 0.05, "mm", side_displaced, "one side of the outline is displaced"),
    ("bump-left", "path", 0.05, "mm", bump, "one line is bent over 6 mm"),
    ("bump-right", "path", 0.05, "mm", lambda s: bump(-s), "bent to the other side"),
    ("circle-large", "path", 0.05, "mm",
     lambda s: edited(CIRCLE, lambda m: [Mark(CIRCLE, centre=m.centre, radius=m.radius + s)]), "a hole is too large"),
    ("circle-small", "path", 0.05, "mm",
     lambda s: edited(CIRCLE, lambda m: [Mark(CIRCLE, centre=m.centre, radius=m.radius - s)]), "a hole is too small"),
    ("corner", "joints", 0.05, "mm", corner_cut_off, "a corner is cut off"),
    ("end-short", "joints", 0.05, "mm", lambda s: end_moved(-s), "a line ends early"),
    ("end-long", "joints", 0.05, "mm", end_moved, "a line ends late"),
    ("start-late", "joints", 0.05, "mm", lambda s: end_moved(-s, ACROSS, True), "a line begins late"),
    ("bridge", "coverage", 0.15, "mm", hole, "a bridge in a line"),
    ("bridge-across", "coverage", 0.15, "mm", lambda s: hole(s, ACROSS), "a bridge in a line across the belt"),
    ("cut-through", "depth", 0.15, "mm", crease_cut_through, "a piece of a crease is cut through"),
    ("stray", "stray", 0.5, "mm", stray, "a cut where nothing is drawn"),
    ("again", "repeat", 1.5, "", cut_again, "a line is cut again"),
    ("drift", "stillness_x", 0.05, "mm", drift, "the beam drifts along x during a cut"),
    ("drift-back", "stillness_x", 0.05, "mm", lambda s: drift(-s), "the other way"),
    ("bow", "stillness_peak", 0.05, "mm", bow, "the beam strays from its mean place during a cut"),
    ("dash-long", "perforation", 0.15, "mm", long_dash, "one cut of a perforation is too long"),
    ("dash-short", "perforation", 0.15, "mm", lambda s: long_dash(-s), "one cut of a perforation is too short"),
    ("dashes-shifted", "perforation", 0.15, "mm", shifted_pattern, "the cuts of a perforation lie aside"),
    ("wide", "ordered_width", 0.02, "mm", ordered_width, "all cuts are too wide"),
    ("narrow", "ordered_width", 0.02, "mm", lambda s: ordered_width(-s), "all cuts are too narrow"),
    ("one-narrow", "kerf_width", 0.02, "mm", narrow_line, "one cut is narrower than the others"),
    ("deep", "ordered_depth", 0.1, "", ordered_depth, "a crease is too deep"),
    ("shallow", "ordered_depth", 0.1, "", lambda s: ordered_depth(-s), "a crease is not deep enough"),
    ("kerf-radius", "edge", 0.05, "mm", kerf_radius, "kerf compensated by too much"),
]
