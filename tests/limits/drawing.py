# SPDX-License-Identifier: Apache-2.0
"""A drawing with a bit of everything, and its G-code, to put faults of a known size into.

Marks are polylines or circles in the frame of the sheet, mm, in the order in which they are cut.
"""
import copy
import math

# Entities of the drawing, in order: kind, layer, geometry.
ENTITIES = [("line", "CUT", (0, -15), (0, 15)), ("line", "CUT", (0, 15), (-50, 15)),
            ("line", "CUT", (-50, 15), (-50, -15)), ("line", "CUT", (-50, -15), (0, -15)),
            ("circle", "CUT", (-12, 0), 4.0), ("line", "CUT", (-22, -9), (-22, 9)),
            ("line", "CUT", (-30, -10), (-40, 8)), ("line", "CREASE", (-45, -10), (-45, 10)),
            ("line", "PERF", (-4, -10), (-4, 10))]
OUTLINE, CIRCLE, ACROSS, ASKEW, CREASE, PERFORATION = 0, 4, 5, 6, 7, 8
CUT_MM, BRIDGE_MM = 3.0, 1.0
MIDDLE = (-25.0, 0.0)


def dxf():
    text = "0\nSECTION\n2\nENTITIES\n"
    for entity in ENTITIES:
        if entity[0] == "line":
            (x0, y0), (x1, y1) = entity[2:]
            text += f"0\nLINE\n8\n{entity[1]}\n10\n{x0}\n20\n{y0}\n11\n{x1}\n21\n{y1}\n"
        else:
            (x, y), r = entity[2:]
            text += f"0\nCIRCLE\n8\n{entity[1]}\n10\n{x}\n20\n{y}\n40\n{r}\n"
    return text + "0\nENDSEC\n0\nEOF\n"


class Mark:
    """A mark of the laser: one polyline, or one circle, with the laser on."""

    def __init__(self, entity, points=None, centre=None, radius=None, z=1.0):
        self.entity, self.points, self.centre, self.radius, self.z = entity, points, centre, radius, z

    def moved(self, move, scale=1.0):
        mark = copy.deepcopy(self)
        if mark.points:
            mark.points = [move(p) for p in mark.points]
        else:
            mark.centre, mark.radius = move(mark.centre), scale * mark.radius
        return mark


def dashes():
    """The perforation as ordered: a whole number of cuts, the first and the last at the ends."""
    (x, y0), (_, y1) = ENTITIES[PERFORATION][2:]
    cuts = round((y1 - y0 + BRIDGE_MM) / (CUT_MM + BRIDGE_MM))
    stretch = (y1 - y0) / (cuts * (CUT_MM + BRIDGE_MM) - BRIDGE_MM)
    starts = [y0 + i * (CUT_MM + BRIDGE_MM) * stretch for i in range(cuts)]
    return [Mark(PERFORATION, [(x, y), (x, y + CUT_MM * stretch)]) for y in starts]


def marks():
    """The flawless job: what leaves the field first, and creases and perforations before cuts."""
    def line(entity, z=1.0):
        return Mark(entity, list(ENTITIES[entity][2:]), z=z)

    corners = [(0, -15), (0, 15), (-50, 15), (-50, -15), (0, -15)]
    return dashes() + [line(CREASE, 0.5), Mark(CIRCLE, centre=(-12.0, 0.0), radius=4.0), line(ACROSS), line(ASKEW),
                       Mark(OUTLINE, corners)]


def gcode(job):
    text = ""
    for mark in job:
        z, name = f"Z{mark.z:.6g}", f"(E{mark.entity})"
        if mark.points:
            (x, y), *rest = mark.points
            text += f"LINE\nG00 X{x:.4f} Y{y:.4f} Z0 {name}\n"
            text += "".join(f"G01 X{x:.4f} Y{y:.4f} {z} {name}\n" for x, y in rest)
        else:
            (x, y), r = mark.centre, mark.radius
            text += f"CIRCLE\nG00 X{x + r:.4f} Y{y:.4f} Z0 {name}\n"
            text += f"G03 X{x + r:.4f} Y{y:.4f} I{-r:.4f} J0.0000 {z} {name}\n"
    return text


def along(a, b, share):
    return tuple(p + share * (q - p) for p, q in zip(a, b))


def aside(a, b, mm):
    """A step to the left of the way from a to b."""
    length = math.dist(a, b)
    return (-mm * (b[1] - a[1]) / length, mm * (b[0] - a[0]) / length)


def plus(p, d):
    return (p[0] + d[0], p[1] + d[1])
