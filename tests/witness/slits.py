# SPDX-License-Identifier: Apache-2.0
"""Slits as solids of POV-Ray: walls upright or leaning, from z = low to z = high, wider at the top."""
import dataclasses
import math

import sheet


@dataclasses.dataclass(frozen=True)
class Walls:
    """Half widths at two heights; between them, and beyond, the walls go on straight."""
    low_mm: float
    high_mm: float
    half_low_mm: float
    half_high_mm: float


def number(value):
    return f"{value:.9g}"


def vector(*values):
    return "<" + ",".join(number(v) for v in values) + ">"


def cone(walls, x, y, radius=0.0, side=1.0):
    """A round wall about (x, y): of a round end (radius 0), or one of an arc's two."""
    low, high = radius + side * walls.half_low_mm, radius + side * walls.half_high_mm
    ends = [vector(x, y, walls.low_mm), vector(x, y, walls.high_mm)]
    if low == high:
        return f"cylinder {{ {ends[0]}, {ends[1]}, {number(low)} }}"
    return f"cone {{ {ends[0]}, {number(low)}, {ends[1]}, {number(high)} }}"


def straight(walls, x0, y0, x1, y1):
    """A prism whose section is a rectangle or a trapezium, flat at both ends."""
    length = math.hypot(x1 - x0, y1 - y0)
    turn = f"rotate {number(math.degrees(math.atan2(y1 - y0, x1 - x0)))}*z translate {vector(x0, y0, 0)}"
    if walls.half_low_mm == walls.half_high_mm:
        box = f"box {{ {vector(0, -walls.half_low_mm, walls.low_mm)}, {vector(length, walls.half_low_mm, walls.high_mm)}"
        return f"{box} {turn} }}"
    # linear_sweep draws the section in x, z and sweeps along y: (section x, z) are (across, up), y runs along the slit.
    section = [(-walls.half_low_mm, walls.low_mm), (walls.half_low_mm, walls.low_mm), (walls.half_high_mm, walls.high_mm),
               (-walls.half_high_mm, walls.high_mm)]
    corners = ", ".join(vector(*p) for p in section + section[:1])
    return f"prism {{ linear_sweep linear_spline 0, {number(length)}, 5, {corners} rotate -90*z {turn} }}"


def ring(walls, x, y, radius):
    deeper = dataclasses.replace(walls, low_mm=walls.low_mm - 1, high_mm=walls.high_mm + 1,
                                 half_low_mm=2 * walls.half_low_mm - at(walls, walls.low_mm + 1),
                                 half_high_mm=at(walls, walls.high_mm + 1))
    return f"difference {{ {cone(walls, x, y, radius)} {cone(deeper, x, y, radius, -1.0)} }}"


def at(walls, z_mm):
    """Half width at a height."""
    slope = (walls.half_high_mm - walls.half_low_mm) / (walls.high_mm - walls.low_mm)
    return walls.half_low_mm + slope * (z_mm - walls.low_mm)


def quarter(walls, start, end):
    """A quarter arc to the left."""
    (x, y), radius, begin = sheet.quarter_arc(start, end)
    wedge = f"box {{ {vector(0, 0, walls.low_mm - 2)}, {vector(radius + 1, radius + 1, walls.high_mm + 2)} }}"
    turn = f"rotate {number(math.degrees(begin))}*z translate {vector(x, y, 0)}"
    return f"intersection {{ {ring(walls, 0, 0, radius)} {wedge} {turn} }}"


def path_solids(walls, path):
    if path.radius:
        # Left of a circle that runs to the left is its inside.
        return [ring(walls, *path.points[0][:2], path.radius - path.beside_mm)]
    solids = []
    for start, end in path.pieces():
        if start[2]:
            solids.append(quarter(walls, start, end))
            continue
        (x0, y0), (x1, y1) = start[:2], end[:2]
        share = path.beside_mm / math.hypot(x1 - x0, y1 - y0)
        dx, dy = -share * (y1 - y0), share * (x1 - x0)
        solids.append(straight(walls, x0 + dx, y0 + dy, x1 + dx, y1 + dy))
        if not path.flat_ends:
            solids += [cone(walls, x0 + dx, y0 + dy), cone(walls, x1 + dx, y1 + dy)]
    return solids


def solids(walls, cut):
    return [solid for path in cut.paths for solid in path_solids(walls, path)]
