# SPDX-License-Identifier: Apache-2.0
"""The slit that a beam leaves: a level set of the fluence of a Gaussian beam that runs along a path at constant speed.

Fluence is a share of that in the middle of a long straight line. A straight line at the level exp(-2 h²/w²) is 2 h wide
(w: the beam's 1/e² radius), so the widths of straight lines choose the levels. Where pieces meet, their fluences add up.
Nothing of the product's takes part.
"""
import dataclasses
import math

import numpy

import sheet

RADIUS_MM = 0.105               # 1/e² radius of the beam that cuts.
FAR_MM = 0.3                    # Farther off, a beam leaves less than 1e-7 of its fluence.
REACH_MM = 0.45                 # Around an end or a corner, the outline is looked up; farther off, pieces stand alone.
END_INSIDE_MM = 0.1             # An outline beyond an end is looked at from here.
DIRECTIONS, HALVINGS = 900, 22
CHORD_MM = 5e-5                 # An outline's points are left out where its chords stay as near as this to it.

_GRID = numpy.linspace(-6.0, 6.0, 120001)
_ERF = numpy.array([math.erf(x) for x in _GRID])
_NODES, _WEIGHTS = numpy.polynomial.legendre.leggauss(40)


def erf(x):
    """Of an array, to 1e-9."""
    return numpy.interp(x, _GRID, _ERF)


def level(half_mm):
    """The fluence at the edge of a straight line of this half width."""
    return math.exp(-2.0 * (half_mm / RADIUS_MM) ** 2)


@dataclasses.dataclass(frozen=True)
class Straight:
    start: tuple
    end: tuple

    def length_mm(self):
        return math.dist(self.start, self.end)

    def fluence(self, x, y):
        length = self.length_mm()
        c, s = ((b - a) / length for a, b in zip(self.start, self.end))
        dx, dy = x - self.start[0], y - self.start[1]
        along, across, scale = c * dx + s * dy, c * dy - s * dx, math.sqrt(2.0) / RADIUS_MM
        return 0.5 * numpy.exp(-(scale * across) ** 2) * (erf(scale * along) - erf(scale * (along - length)))


@dataclasses.dataclass(frozen=True)
class Arc:
    """To the left; `turn` from its first angle on."""
    centre: tuple
    radius: float
    begin: float
    turn: float

    def length_mm(self):
        return self.radius * self.turn

    def fluence(self, x, y):
        """By Gauss and Legendre over the part of the arc that is near."""
        dx, dy = x - self.centre[0], y - self.centre[1]
        middle, half = self.begin + 0.5 * self.turn, 0.5 * self.turn
        away = numpy.mod(numpy.arctan2(dy, dx) - middle + math.pi, 2.0 * math.pi) - math.pi
        near = FAR_MM / (self.radius - FAR_MM)
        low, high = away - near, away + near
        if self.turn < 2.0 * math.pi:
            low, high = numpy.clip(low, -half, half), numpy.clip(high, -half, half)
        distance, total = numpy.hypot(dx, dy), 0.0
        for node, weight in zip(_NODES, _WEIGHTS):
            angle = 0.5 * (low + high) + 0.5 * (high - low) * node - away
            square = distance ** 2 + self.radius ** 2 - 2.0 * self.radius * distance * numpy.cos(angle)
            total = total + weight * numpy.exp(-2.0 * square / RADIUS_MM ** 2)
        return total * 0.5 * (high - low) * self.radius * math.sqrt(2.0 / math.pi) / RADIUS_MM

    def radii(self, half_mm):
        """Of the outline far from the arc's ends, inside and outside: a bend moves both inwards."""
        whole = Arc((0.0, 0.0), self.radius, 0.0, 2.0 * math.pi)
        return tuple(self.radius + side * distance_to([whole], (self.radius, 0.0), (side, 0.0), half_mm)
                     for side in (-1, 1))


def pieces(path):
    """The beam's way along a path."""
    if path.radius:
        # Left of a circle that runs to the left is its inside.
        return [Arc(path.points[0][:2], path.radius - path.beside_mm, 0.0, 2.0 * math.pi)]
    found = []
    for start, end in path.pieces():
        if start[2]:
            found.append(Arc(*sheet.quarter_arc(start, end), 0.5 * math.pi))
            continue
        share = path.beside_mm / math.dist(start[:2], end[:2])
        dx, dy = -share * (end[1] - start[1]), share * (end[0] - start[0])
        found.append(Straight((start[0] + dx, start[1] + dy), (end[0] + dx, end[1] + dy)))
    if any(piece.length_mm() < 2.0 * REACH_MM for piece in found):
        raise ValueError(f"a piece of a path is shorter than {2.0 * REACH_MM} mm")
    return found


def fluence(beams, x, y):
    return sum(piece.fluence(x, y) for piece in beams)


def crossings(beams, origin, ways, half_mm, reach_mm):
    """How far it is from a place within the slit to its edge, by directions (rows of x, y); at most `reach_mm`.

    Refuses a direction that leaves the slit and comes back to it, and a place that is not in the slit.
    """
    ways, least = numpy.asarray(ways, float), level(half_mm)

    def inside(distance):
        return fluence(beams, origin[0] + distance * ways[:, 0], origin[1] + distance * ways[:, 1]) >= least
    seen = numpy.array([inside(distance) for distance in numpy.linspace(0.0, reach_mm, 46)])
    if not seen[0].all() or (numpy.diff(seen.astype(int), axis=0) > 0).any():
        raise ValueError(f"the slit about {origin} is no star about it")
    low, high = numpy.zeros(len(ways)), numpy.full(len(ways), reach_mm)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        within = inside(middle)
        low, high = numpy.where(within, middle, low), numpy.where(within, high, middle)
    return high


def distance_to(beams, origin, way, half_mm):
    return float(crossings(beams, origin, [way], half_mm, FAR_MM)[0])


@dataclasses.dataclass(frozen=True)
class Joint:
    """An end, or where two pieces meet: the slit around it, seen from a place within it."""
    beams: tuple
    origin: tuple

    def outline(self, half_mm):
        """Points (x, y) around the slit, cut off at REACH_MM."""
        angles = numpy.arange(DIRECTIONS) * (2.0 * math.pi / DIRECTIONS)
        ways = numpy.stack([numpy.cos(angles), numpy.sin(angles)], axis=1)
        away = crossings(self.beams, self.origin, ways, half_mm, REACH_MM)
        return thinned(numpy.asarray(self.origin) + away[:, None] * ways)


def joints(path, beams):
    """Of the beam's way along a path. A circle has none: it ends where it began."""
    if path.radius:
        return []
    found = [Joint((a, b), path.points[i + 1][:2]) for i, (a, b) in enumerate(zip(beams, beams[1:]))]
    if path.closed:
        return found + [Joint((beams[-1], beams[0]), path.points[0][:2])]
    return found + [Joint((beams[0],), along(beams[0], END_INSIDE_MM)),
                    Joint((beams[-1],), along(beams[-1], beams[-1].length_mm() - END_INSIDE_MM))]


def along(straight, mm):
    share = mm / straight.length_mm()
    return tuple(a + share * (b - a) for a, b in zip(straight.start, straight.end))


def thinned(points):
    """Without points that lie on the chords of their neighbours (Douglas and Peucker 1973)."""
    keep, spans = {0}, [(0, len(points) // 2), (len(points) // 2, len(points))]
    closed = numpy.concatenate([points, points[:1]])
    while spans:
        first, last = spans.pop()
        keep |= {first, last % len(points)}
        dx, dy = closed[last] - closed[first]
        between = closed[first + 1:last] - closed[first]
        if not len(between):
            continue
        off = numpy.abs(dx * between[:, 1] - dy * between[:, 0]) / math.hypot(dx, dy)
        if off.max() > CHORD_MM:
            middle = first + 1 + int(off.argmax())
            spans += [(first, middle), (middle, last)]
    return points[sorted(keep)]


def middle_and_width(path, point, normal, half_mm):
    """Of the slit across a place of the drawing: how far its middle lies along the normal, and its width."""
    beams = pieces(path)
    origin = tuple(p + path.beside_mm * n for p, n in zip(point, normal))
    left, right = (distance_to(beams, origin, (side * normal[0], side * normal[1]), half_mm) for side in (1, -1))
    return path.beside_mm + 0.5 * (left - right), left + right
