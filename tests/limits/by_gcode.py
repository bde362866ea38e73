# SPDX-License-Identifier: Apache-2.0
"""Faults in the job: another G-code than the drawing asks for."""
import math

from drawing import (ACROSS, ASKEW, CIRCLE, CREASE, MIDDLE, OUTLINE, PERFORATION, Mark, along, aside, marks, plus)
from job import ENERGY, Job, energy_of, peak, width


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


def larger_hole(size_mm):
    return edited(CIRCLE, lambda mark: [Mark(CIRCLE, centre=mark.centre, radius=mark.radius + size_mm)])


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


def bridges(share):
    """Four bridges in a side of the outline; all but one of them are this share of its length."""
    def change(mark):
        a, b = (0, 15), (-50, 15)
        at = mark.points.index(a)
        if mark.points[at + 1:at + 2] != [b]:
            raise ValueError("the side is not cut from right to left")
        half = 0.5 * share / 3.0
        ends = [along(a, b, 0.2 * i + sign * half) for i in range(1, 5) for sign in (-1, 1)]
        parts = [mark.points[:at + 1] + ends[:1]]
        parts += [ends[i:i + 2] for i in range(1, len(ends) - 1, 2)]
        parts.append(ends[-1:] + mark.points[at + 1:])
        return [Mark(OUTLINE, points) for points in parts]
    return edited(OUTLINE, change)


def crease_in_three(middle_mm, z):
    """The crease with another depth in its middle."""
    def change(mark):
        a, b = mark.points
        half = 0.5 * middle_mm / math.dist(a, b)
        before, after = along(a, b, 0.5 - half), along(a, b, 0.5 + half)
        return [Mark(CREASE, [a, before], z=0.5), Mark(CREASE, [before, after], z=z), Mark(CREASE, [after, b], z=0.5)]
    return edited(CREASE, change)


def crease_cut_through(size_mm):
    return crease_in_three(size_mm, 1.0)


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
    job = marks()
    own = [i for i, mark in enumerate(job) if mark.entity == PERFORATION][number]
    a, b = job[own].points
    job[own] = Mark(PERFORATION, [a, (b[0], b[1] + size_mm)])
    return Job(job)


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
    return Job(job.marks, f"planner: {{cut_energy_j_per_mm: {energy:.6f}}}\n"
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


def uneven_depth(share):
    """8 mm of a crease are deeper than the rest; depth goes with fluence."""
    job = crease_in_three(8.0, 0.5 * (1.0 + share))
    job.keys = "checks: {even_depth_share: 0.1}\n"
    return job


def points_swapped(passes):
    """Two points of a line come in the wrong order: the beam goes back between them, and forth again."""
    def change(mark):
        a, b = mark.points
        half = 0.25 * (passes - 1.0)
        return [Mark(ACROSS, [a, along(a, b, 0.5 + half), along(a, b, 0.5 - half), b])]
    return edited(ACROSS, change)


def off_for_camera(size_mm):
    """The job is displaced, where only the spot's own limit is tight: path_mm and 0.012."""
    job = all_moved(lambda p: (p[0], p[1] + size_mm))
    job.keys = "checks: {path_mm: 0.1}\n"
    return job
