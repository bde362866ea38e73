# SPDX-License-Identifier: Apache-2.0
"""Length per process and box of a drawing, read by ezdxf or svgelements and integrated numerically. It shares
nothing with the reader under test: parsing, transforms and curves are the libraries' own."""
import math
import re

import numpy as np

NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)
PARTS = 64
MM = {"mm": 1.0, "cm": 10.0, "in": 25.4, "pt": 25.4 / 72}
PROCESS_OF_LAYER = {"0": "cut", "CUT": "cut", "CREASE": "crease", "PERF": "perforation"}
PROCESS_OF_STROKE = {"#ff0000": "cut", "#000000": "cut", "#0000ff": "crease", "#00ffff": "perforation"}


class Sum:
    def __init__(self):
        self.lengths_mm = {}
        self.low = np.array([np.inf, np.inf])
        self.high = -self.low

    def add(self, process, length_mm, points_mm):
        self.lengths_mm[process] = self.lengths_mm.get(process, 0.0) + float(length_mm)
        points = np.atleast_2d(np.asarray(points_mm, float))
        self.low = np.minimum(self.low, points.min(axis=0))
        self.high = np.maximum(self.high, points.max(axis=0))

    def result(self):
        return {"lengths_mm": self.lengths_mm, "box_mm": [*self.low, *self.high]}


def extremes(point, count=4096):
    """Points of a curve on [0, 1] at the ends of its box: samples, then a parabola through the nearest three."""
    u = np.linspace(0.0, 1.0, count + 1)
    p = point(u)
    found = [p[0], p[-1]]
    for axis in (0, 1):
        for sign in (1.0, -1.0):
            k = int(np.argmax(sign * p[:, axis]))
            found.append(p[k])
            if 0 < k < count:
                a, b, c = p[k - 1, axis], p[k, axis], p[k + 1, axis]
                bend = a - 2 * b + c
                if bend:
                    found.append(point(np.array([u[k] + 0.5 * (a - c) / bend / count]))[0])
    return np.array(found)


def arc_length(derivative):
    """Length of a smooth curve on [0, 1] from its derivative."""
    edges = np.linspace(0.0, 1.0, PARTS + 1)
    half = 0.5 / PARTS
    u = (edges[:-1, None] + half + half * NODES[None, :]).ravel()
    speed = np.linalg.norm(derivative(u), axis=1).reshape(PARTS, -1)
    return float((speed * WEIGHTS[None, :]).sum() * half)


def bezier(points, weights=None):
    """Point and derivative of a Bezier curve of any degree by its polynomials."""
    points = np.asarray(points, float)
    degree = len(points) - 1
    factors = [math.comb(degree, i) for i in range(degree + 1)]

    def point(u):
        return sum(f * (u**i * (1 - u) ** (degree - i))[:, None] * points[i] for i, f in enumerate(factors))

    def derivative(u):
        low = [math.comb(degree - 1, i) for i in range(degree)]
        return degree * sum(
            f * (u**i * (1 - u) ** (degree - 1 - i))[:, None] * (points[i + 1] - points[i])
            for i, f in enumerate(low))
    return point, derivative


def ellipse(centre, major, minor, start, sweep):
    def point(u):
        t = start + u * sweep
        return centre + np.cos(t)[:, None] * major + np.sin(t)[:, None] * minor

    def derivative(u):
        t = start + u * sweep
        return sweep * (np.cos(t)[:, None] * minor - np.sin(t)[:, None] * major)
    return point, derivative


def add_curve(total, process, curve):
    point, derivative = curve
    total.add(process, arc_length(derivative), extremes(point))


# DXF by ezdxf

def flat(vector):
    return np.array([vector.x, vector.y])


def dxf_entities(entities, layer_of_insert="0"):
    """Entities with all inserts and polylines taken apart; layer 0 of a block is that of its insert."""
    for entity in entities:
        if entity.dxf.layer == "0":
            entity.dxf.layer = layer_of_insert
        if entity.dxftype() == "INSERT":
            copies = entity.multi_insert() if entity.mcount > 1 else [entity]
            for copy in copies:
                yield from dxf_entities(copy.virtual_entities(), entity.dxf.layer)
        elif entity.dxftype() in ("LWPOLYLINE", "POLYLINE"):
            yield from entity.virtual_entities()
        else:
            yield entity


def dxf_arc(entity, scale, start_deg, end_deg):
    """An arc with its extrusion undone by ezdxf's own frame."""
    from ezdxf.math import Vec3
    ocs = entity.ocs()
    radius = scale * entity.dxf.radius
    centre = scale * flat(ocs.to_wcs(entity.dxf.center))
    x = flat(Vec3(ocs.to_wcs((1, 0, 0))))
    y = flat(Vec3(ocs.to_wcs((0, 1, 0))))
    start = math.radians(start_deg)
    sweep = math.radians(end_deg - start_deg)
    sweep = sweep % (2 * math.pi) or 2 * math.pi
    return ellipse(centre, radius * x, radius * y, start, sweep)


def read_dxf(path, scale):
    """`scale`: millimetres per unit, as the writer meant it; ezdxf takes metres where a file does not say."""
    import ezdxf
    drawing = ezdxf.readfile(path)
    total = Sum()
    for entity in dxf_entities(drawing.modelspace()):
        process = PROCESS_OF_LAYER[entity.dxf.layer]
        kind = entity.dxftype()
        if kind == "LINE":
            ends = scale * np.array([flat(entity.dxf.start), flat(entity.dxf.end)])
            total.add(process, np.linalg.norm(ends[1] - ends[0]), ends)
        elif kind == "ARC":
            add_curve(total, process, dxf_arc(entity, scale, entity.dxf.start_angle, entity.dxf.end_angle))
        elif kind == "CIRCLE":
            add_curve(total, process, dxf_arc(entity, scale, 0.0, 360.0))
        elif kind == "ELLIPSE":
            start, end = entity.dxf.start_param, entity.dxf.end_param
            sweep = (end - start) % (2 * math.pi) or 2 * math.pi
            curve = ellipse(scale * flat(entity.dxf.center), scale * flat(entity.dxf.major_axis),
                            scale * flat(entity.minor_axis), start, sweep)
            add_curve(total, process, curve)
        elif kind == "SPLINE":
            for part in entity.construction_tool().bezier_decomposition():
                add_curve(total, process, bezier([scale * flat(p) for p in part]))
        else:
            raise ValueError(f"{path}: the second reader takes no {kind}")
    return total.result()


# SVG by svgelements

def read_svg(path, mm_per_px):
    """`mm_per_px`: 25.4 / 96, or what a user unit is where the file gives its size without one."""
    import svgelements
    total = Sum()
    pixels = svgelements.SVG.parse(path, reify=False, ppi=96.0)
    # svgelements rounds the px of a millimetre to 3.7795: the page's own width says what they are.
    width = re.search(r"<svg[^>]*?\bwidth=[\"']([\d.]+)(mm|cm|in|pt)[\"']", path.read_text())
    if width:
        mm_per_px = float(width[1]) * MM[width[2]] / float(pixels.width)
    height_mm = mm_per_px * float(pixels.height)

    def place(point):
        return np.array([mm_per_px * point.x, height_mm - mm_per_px * point.y])

    for element in pixels.elements():
        if not isinstance(element, svgelements.Shape) or element.stroke is None or element.stroke.value is None:
            continue
        process = PROCESS_OF_STROKE[element.stroke.hexrgb.lower()]
        for segment in abs(svgelements.Path(element)):
            if isinstance(segment, svgelements.Move) or segment.start is None:
                continue
            if isinstance(segment, (svgelements.Line, svgelements.Close)):
                if segment.end is not None:
                    ends = np.array([place(segment.start), place(segment.end)])
                    total.add(process, np.linalg.norm(ends[1] - ends[0]), ends)
            elif isinstance(segment, svgelements.QuadraticBezier):
                add_curve(total, process, bezier([place(p) for p in (segment.start, segment.control, segment.end)]))
            elif isinstance(segment, svgelements.CubicBezier):
                points = (segment.start, segment.control1, segment.control2, segment.end)
                add_curve(total, process, bezier([place(p) for p in points]))
            else:
                centre = place(segment.center)
                major = place(segment.prx) - centre
                minor = place(segment.pry) - centre
                start = segment.get_start_t()
                add_curve(total, process, ellipse(centre, major, minor, start, segment.sweep))
    return total.result()
