# SPDX-License-Identifier: Apache-2.0
"""Slits as solids of POV-Ray: walls upright or leaning, from z = low to z = high, wider at the top.

Straight pieces and arcs are bodies of their own; ends and corners are prisms between them, which reach over them.
"""
import dataclasses
import functools
import math

import beam

OVERLAP_MM = 0.1                # Pieces and joints reach over each other by this.
STEP_MM = 3e-4                  # Leaning walls of joints are stairs with steps no wider than this.
SPARE_MM = 0.01                 # Around what a box bounds.
LEAF, LARGE_MM = 3, 8.0         # Solids that are bounded together; larger ones are alone.


@dataclasses.dataclass(frozen=True)
class Walls:
    """Half widths of a straight line at two heights; between them, and beyond, its walls go on straight."""
    low_mm: float
    high_mm: float
    half_low_mm: float
    half_high_mm: float

    def stairs(self):
        """Heights from which on a slit is as wide as this up to its top, and half widths: the middle of each step."""
        rise, widening = self.high_mm - self.low_mm, self.half_high_mm - self.half_low_mm
        count = max(1, math.ceil(widening / STEP_MM))
        return [(self.low_mm + rise * i / count, self.half_low_mm + widening * (i + 0.5) / count) for i in range(count)]


def number(value):
    return f"{value:.9g}"


def vector(*values):
    return "<" + ",".join(number(v) for v in values) + ">"


def union(solids, more=""):
    return "union {\n" + "\n".join(solids) + f"\n{more} }}\n"


def prism(points, low, high):
    """An upright one over a polygon. linear_sweep draws it in x and z and sweeps it along y."""
    corners = ", ".join(vector(*point) for point in [*points, points[0]])
    return (f"prism {{ linear_sweep linear_spline {number(low)}, {number(high)}, {len(points) + 1}, {corners} "
            "matrix <1,0,0, 0,0,1, 0,1,0, 0,0,0> }")


def cone(walls, centre, low, high):
    """A round wall whose radius is `low` at the walls' foot and `high` at their top."""
    ends = [vector(*centre, walls.low_mm), vector(*centre, walls.high_mm)]
    if low == high:
        return f"cylinder {{ {ends[0]}, {ends[1]}, {number(low)} }}"
    return f"cone {{ {ends[0]}, {number(low)}, {ends[1]}, {number(high)} }}"


def straight(walls, start, end):
    """A prism whose section is a rectangle or a trapezium, flat at both ends."""
    length = math.dist(start, end)
    angle = math.atan2(end[1] - start[1], end[0] - start[0])
    turn = f"rotate {number(math.degrees(angle))}*z translate {vector(*start, 0)}"
    if walls.half_low_mm == walls.half_high_mm:
        low, high = vector(0, -walls.half_low_mm, walls.low_mm), vector(length, walls.half_low_mm, walls.high_mm)
        return f"box {{ {low}, {high} {turn} }}"
    # linear_sweep draws the section in x, z and sweeps along y: x, z are (across, up), y runs along the slit.
    section = [(-walls.half_low_mm, walls.low_mm), (walls.half_low_mm, walls.low_mm),
               (walls.half_high_mm, walls.high_mm), (-walls.half_high_mm, walls.high_mm)]
    corners = ", ".join(vector(*p) for p in section + section[:1])
    return f"prism {{ linear_sweep linear_spline 0, {number(length)}, 5, {corners} rotate -90*z {turn} }}"


def ring(walls, arc):
    (low_in, low_out), (high_in, high_out) = arc.radii(walls.half_low_mm), arc.radii(walls.half_high_mm)
    # The hole goes on beyond both faces of the ring: no two surfaces lie in one plane.
    slope = (high_in - low_in) / (walls.high_mm - walls.low_mm)
    deeper = dataclasses.replace(walls, low_mm=walls.low_mm - 1, high_mm=walls.high_mm + 1)
    return (f"difference {{ {cone(walls, arc.centre, low_out, high_out)} "
            f"{cone(deeper, arc.centre, low_in - slope, high_in + slope)} }}")


def sector(walls, arc, short):
    """An arc that ends an angle `short` before both of its ends."""
    angles = [arc.begin + short, arc.begin + 0.5 * arc.turn, arc.begin + arc.turn - short]
    x, y = arc.centre
    corners = [(x + 2.0 * arc.radius * math.cos(a), y + 2.0 * arc.radius * math.sin(a)) for a in angles]
    return f"intersection {{ {ring(walls, arc)} {prism([(x, y), *corners], walls.low_mm - 2, walls.high_mm + 2)} }}"


@dataclasses.dataclass(frozen=True)
class Solid:
    text: str
    box: tuple                  # Least x, y, and largest.

    def middle(self, axis):
        return self.box[axis] + self.box[axis + 2]


def around(boxes):
    return tuple(pick(box[i] for box in boxes) for i, pick in enumerate((min, min, max, max)))


def body(walls, piece):
    """A piece between its joints."""
    short, half = beam.REACH_MM - OVERLAP_MM, walls.half_high_mm
    if isinstance(piece, beam.Straight):
        ends = beam.along(piece, short), beam.along(piece, piece.length_mm() - short)
        return Solid(straight(walls, *ends), around([(x - half, y - half, x + half, y + half) for x, y in ends]))
    (x, y), reach = piece.centre, piece.radius + half
    text = sector(walls, piece, short / piece.radius) if piece.turn < 2.0 * math.pi else ring(walls, piece)
    return Solid(text, (x - reach, y - reach, x + reach, y + reach))


def stairs(walls, joint):
    outlines = [(low, joint.outline(half)) for low, half in walls.stairs()]
    box = around([(*outline.min(axis=0), *outline.max(axis=0)) for _, outline in outlines])
    return bounded([Solid(prism(outline, low, walls.high_mm), box) for low, outline in outlines], walls)


def bounded(parts, walls):
    """One solid of several. POV-Ray bounds no parts of a union by itself: `bounded_by` spares it rays, and the
    intersection with the same box spares it places that may lie inside."""
    box = around([part.box for part in parts])
    low, high = (vector(*(v + side * SPARE_MM for v in (*corner, z))) for side, corner, z in
                 ((-1, box[:2], walls.low_mm), (1, box[2:], walls.high_mm)))
    text = union([part.text for part in parts]) if len(parts) > 1 else parts[0].text
    return Solid(f"intersection {{ box {{ {low}, {high} }}\n{text} bounded_by {{ box {{ {low}, {high} }} }} }}", box)


def tree(parts, walls):
    """Near ones together, two by two."""
    if len(parts) <= LEAF:
        return bounded(parts, walls)
    box = around([part.box for part in parts])
    axis = 0 if box[2] - box[0] > box[3] - box[1] else 1
    parts, half = sorted(parts, key=lambda part: part.middle(axis)), len(parts) // 2
    return bounded([tree(parts[:half], walls), tree(parts[half:], walls)], walls)


@functools.lru_cache(maxsize=None)
def solids(walls, cut):
    """Of all paths of a sheet."""
    bodies, found = [], []
    for path in cut.paths:
        beams = beam.pieces(path)
        bodies += [body(walls, piece) for piece in beams]
        found += [stairs(walls, joint) for joint in beam.joints(path, beams)]
    large = [solid for solid in bodies if max(solid.box[2] - solid.box[0], solid.box[3] - solid.box[1]) > LARGE_MM]
    return [solid.text for solid in (*large, tree([*found, *(s for s in bodies if s not in large)], walls))]
