# SPDX-License-Identifier: Apache-2.0
"""Sheets as ordered and as cut: one list gives the drawing (DXF) and the slits (solids of POV-Ray).

Frame U: middle of the sheet, mm, y away from x by a quarter turn to the left. The drawing's frame S is shifted by
Sheet.p_SU_mm. A slit may lie beside its line by a known distance, positive to the left: that is the truth which the
bench has to find.
"""
import dataclasses
import math

QUARTER_BULGE = math.tan(math.pi / 8)


@dataclasses.dataclass(frozen=True)
class Path:
    """Straight and quarter-arc pieces through points (x, y, bulge); or a circle (one point, a radius)."""
    points: tuple
    closed: bool = False
    radius: float = 0.0
    beside_mm: float = 0.0      # Of straight lines and circles alone.

    def pieces(self):
        """Pairs of points: what the bench calls entities. A circle is one of them."""
        if self.radius:
            return [(self.points[0], self.points[0])]
        last = len(self.points) if self.closed else len(self.points) - 1
        return [(self.points[i], self.points[(i + 1) % len(self.points)]) for i in range(last)]


@dataclasses.dataclass(frozen=True)
class Sheet:
    half_size_mm: tuple         # Of the board, beyond all that the camera sees.
    paths: tuple
    marks: tuple
    mark_mm: float
    p_SU_mm: tuple


@dataclasses.dataclass(frozen=True)
class Entity:
    """A piece of the drawing, and how it was cut."""
    start: tuple
    end: tuple
    path: Path

    def at(self, u):
        """The point at the share u of it, and the normal to its left."""
        (x0, y0), (x1, y1) = self.start[:2], self.end[:2]
        if self.path.radius:
            return on_arc((x0, y0), self.path.radius, 2.0 * math.pi * u)
        if self.start[2]:
            centre, radius, begin = quarter_arc(self.start, self.end)
            return on_arc(centre, radius, begin + 0.5 * math.pi * u)
        length = math.hypot(x1 - x0, y1 - y0)
        return (x0 + u * (x1 - x0), y0 + u * (y1 - y0)), (-(y1 - y0) / length, (x1 - x0) / length)


def on_arc(centre, radius, angle):
    """Of an arc to the left, whose left is its inside."""
    c, s = math.cos(angle), math.sin(angle)
    return (centre[0] + radius * c, centre[1] + radius * s), (-c, -s)


def quarter_arc(start, end):
    """Centre, radius and first angle of a quarter to the left."""
    (x0, y0), (x1, y1) = start[:2], end[:2]
    x, y = 0.5 * (x0 + x1 - (y1 - y0)), 0.5 * (y0 + y1 + (x1 - x0))
    return (x, y), math.hypot(x0 - x, y0 - y), math.atan2(y0 - y, x0 - x)


def entities(sheet):
    """In the order of the drawing."""
    return [Entity(a, b, path) for path in sheet.paths for a, b in path.pieces()]


def line(x0, y0, x1, y1, beside_mm=0.0):
    return Path(((x0, y0, 0.0), (x1, y1, 0.0)), beside_mm=beside_mm)


def circle(x, y, radius, beside_mm=0.0):
    return Path(((x, y, 0.0),), closed=True, radius=radius, beside_mm=beside_mm)


def polyline(*points, closed=False):
    return Path(tuple((x, y, 0.0) for x, y in points), closed=closed)


def rectangle(a, b):
    return polyline((-a, -b), (a, -b), (a, b), (-a, b), closed=True)


def rounded(a, b, r):
    q = QUARTER_BULGE
    return Path(((-a + r, -b, 0.0), (a - r, -b, q), (a, -b + r, 0.0), (a, b - r, q), (a - r, b, 0.0), (-a + r, b, q),
                 (-a, b - r, 0.0), (-a, -b + r, q)), closed=True)


def full_sheet(beside_mm):
    """53 x 36 mm: as far into the corners of a field of 61 x 46 mm as roll and lays allow."""
    d = beside_mm
    paths = [rectangle(26.5, 18.0), rounded(17.0, 11.0, 4.0), circle(0.0, 0.0, 5.0, d)]
    lines = [(-12, 15, 6, 15), (-12, -15, 12, -15), (-22, -9, -22, 9), (22, -9, 22, 9), (-14, -8, -6, -5), (7, -4, 13, -8),
             (-13, 3, -8, 8), (9, 1, 15, 1.8), (24.4, 11, 24.4, 16.2), (-24.4, -16.2, -24.4, -11), (-24.9, 10.5, -24.2, 16.2),
             (19.5, -16.2, 24.5, -16.1), (-16.6, 13.9, -14.1, 16.4), (14.5, -13, 17.2, -15.9), (-19.5, -6, -18.8, 5),
             (19.3, -4, 19.8, 6)]
    paths += [line(*ends, beside_mm=d if i % 3 else -d) for i, ends in enumerate(lines)]
    paths += [polyline((-4, -9.5), (0, -6.5), (4, -9.5)), polyline((6.5, 6.0), (11, 6.5), (11.3, 9.3)),
              polyline((-5, 7), (-1, 9.3), (4, 7.3)), polyline((-18.8, 16.2), (-18.2, 12.3), (-14.5, 12.6))]
    return Sheet((60.0, 50.0), tuple(paths), ((-21.5, -14.5), (-21.5, 14.5), (21.5, -13.5), (21.5, 14.5), (11.0, 15.2)),
                 3.0, (-30.0, 0.0))


def small_sheet(beside_mm):
    """For a camera of 640 x 480 pixels; its marks are as small as the spot camera sees."""
    d = beside_mm
    paths = (rectangle(7.6, 5.4), circle(0.0, -0.5, 1.5, d), line(-5.7, -1.9, -5.5, 1.8, d), line(5.6, -1.9, 5.6, 1.9, d),
             line(-3.6, 3.4, 3.4, 3.5, d), line(-3.5, -3.6, 3.5, -3.5, -d))
    return Sheet((15.0, 12.0), paths, ((-5.6, -3.5), (-5.6, 3.5), (5.6, -3.5), (5.6, 3.5), (3.0, 1.2)), 1.8, (-30.0, 0.0))


def dxf(sheet):
    """The drawing, in S."""
    def shifted(point):
        return point[0] + sheet.p_SU_mm[0], point[1] + sheet.p_SU_mm[1]
    groups = [(0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1015"), (9, "$INSUNITS"), (70, 4), (0, "ENDSEC"),
              (0, "SECTION"), (2, "ENTITIES")]
    for path in sheet.paths:
        x, y = shifted(path.points[0])
        if path.radius:
            groups += [(0, "CIRCLE"), (100, "AcDbEntity"), (8, "CUT"), (100, "AcDbCircle"), (10, x), (20, y), (40, path.radius)]
        else:
            groups += [(0, "LWPOLYLINE"), (100, "AcDbEntity"), (8, "CUT"), (100, "AcDbPolyline"), (90, len(path.points)),
                       (70, int(path.closed))]
            for point in path.points:
                x, y = shifted(point)
                groups += [(10, x), (20, y), (42, point[2])]
    groups += [(0, "ENDSEC"), (0, "EOF")]
    return "".join(f"{code}\n{value}\n" for code, value in groups)
