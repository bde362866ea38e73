# SPDX-License-Identifier: Apache-2.0
"""Lengths and boxes of curves in the plane, in mm, with points as complex numbers. It shares nothing with the reader
that is witnessed: integrals by 16 points of Gauss and Legendre, ends of boxes by the zeros of derivatives."""
import cmath
import math

NOTHING_MM = 1e-9  # Lines no longer than this are none.


def _legendre(n):
    """Nodes and weights on [0, 1] (Abramowitz & Stegun 25.4.29), the zeros by Newton."""
    rule = []
    for i in range(n):
        x = math.cos(math.pi * (i + 0.75) / (n + 0.5))
        slope = 0.0
        for _ in range(100):
            before, value = 1.0, x
            for k in range(2, n + 1):
                before, value = value, ((2 * k - 1) * x * value - (k - 1) * before) / k
            slope = n * (x * value - before) / (x * x - 1)
            step = value / slope
            x -= step
            if abs(step) < 1e-16:
                break
        rule.append(((1 + x) / 2, 1 / ((1 - x * x) * slope * slope)))
    return rule


RULE = _legendre(16)


def integral(speed, a, b, depth=40, whole=None):
    """Integral of a speed over [a, b], halved until both halves add up to the whole."""
    def over(low, high):
        return (high - low) * sum(w * speed(low + (high - low) * x) for x, w in RULE)
    if whole is None:
        whole = over(a, b)
    middle = (a + b) / 2
    left, right = over(a, middle), over(middle, b)
    if depth == 0 or abs(left + right - whole) <= 1e-11 * (1 + abs(whole)):
        return left + right
    return integral(speed, a, middle, depth - 1, left) + integral(speed, middle, b, depth - 1, right)


class Line:
    def __init__(self, start, end):
        self.ends = (start, end)

    def length(self):
        return abs(self.ends[1] - self.ends[0])

    def reach(self):
        return self.ends


class Bezier:
    """A plain Bezier curve of degree 1 to 3."""

    def __init__(self, *points):
        self.points = points

    def point(self, u):
        row = self.points
        while len(row) > 1:
            row = [a + u * (b - a) for a, b in zip(row, row[1:])]
        return row[0]

    def derivative(self, u):
        degree = len(self.points) - 1
        return Bezier(*[degree * (b - a) for a, b in zip(self.points, self.points[1:])]).point(u)

    def length(self):
        return sum(integral(lambda u: abs(self.derivative(u)), i / 4, (i + 1) / 4) for i in range(4))

    def reach(self):
        found = [self.points[0], self.points[-1]]
        for part in (lambda p: p.real, lambda p: p.imag):
            for u in _zeros([part(b) - part(a) for a, b in zip(self.points, self.points[1:])]):
                if 0 < u < 1:
                    found.append(self.point(u))
        return found


def _zeros(steps):
    """Zeros of a polynomial of degree 0 to 2 that is given by its Bernstein coefficients."""
    if len(steps) == 2:
        bend, slope, value = 0.0, steps[1] - steps[0], steps[0]
    elif len(steps) == 3:
        bend, slope, value = steps[0] - 2 * steps[1] + steps[2], 2 * (steps[1] - steps[0]), steps[0]
    else:
        return []
    root = slope * slope - 4 * bend * value
    if root < 0:
        return []
    # The form that does not cancel (Numerical Recipes, 5.6).
    q = -(slope + math.copysign(math.sqrt(root), slope)) / 2
    return ([q / bend] if bend else []) + ([value / q] if q else [])


class Ellipse:
    """centre + major cos t + minor sin t, t from start to start + sweep; a circle's arc as well."""

    def __init__(self, centre, major, minor, start, sweep):
        self.centre, self.major, self.minor, self.start, self.sweep = centre, major, minor, start, sweep

    def at(self, t):
        return self.centre + math.cos(t) * self.major + math.sin(t) * self.minor

    def length(self):
        a, b = abs(self.major), abs(self.minor)
        if abs(a - b) <= 1e-14 * a and abs((self.major.conjugate() * self.minor).real) <= 1e-14 * a * b:
            return a * abs(self.sweep)
        low, high = sorted((self.start, self.start + self.sweep))
        return sum(integral(lambda t: abs(math.cos(t) * self.minor - math.sin(t) * self.major),
                            low + (high - low) * i / 4, low + (high - low) * (i + 1) / 4) for i in range(4))

    def reach(self):
        low, high = sorted((self.start, self.start + self.sweep))
        found = [self.at(low), self.at(high)]
        for major, minor in ((self.major.real, self.minor.real), (self.major.imag, self.minor.imag)):
            t = math.atan2(minor, major)
            t += math.pi * math.ceil((low - t) / math.pi)
            while t < high:
                found.append(self.at(t))
                t += math.pi
        return found


class Sampled:
    """A smooth curve by its point and derivative on [0, 1]; ends of its box by samples and a parabola."""

    def __init__(self, point, derivative):
        self.point, self.derivative = point, derivative

    def length(self):
        return sum(integral(lambda u: abs(self.derivative(u)), i / 4, (i + 1) / 4) for i in range(4))

    def reach(self, count=512):
        p = [self.point(i / count) for i in range(count + 1)]
        found = [p[0], p[-1]]
        for turn in (1, -1, 1j, -1j):
            k = max(range(count + 1), key=lambda i: (turn * p[i]).real)
            found.append(p[k])
            if 0 < k < count:
                a, b, c = ((turn * q).real for q in p[k - 1:k + 2])
                if a - 2 * b + c:
                    found.append(self.point((k + 0.5 * (a - c) / (a - 2 * b + c)) / count))
        return found


class Sheet:
    """Sums of lengths and boxes by what lines are known by, after scale, turn and shift."""

    def __init__(self, scale=1.0, turn_deg=0.0, shift_mm=(0.0, 0.0)):
        self.turn = scale if turn_deg == 0 else cmath.rect(scale, math.radians(turn_deg))
        self.shift = complex(*shift_mm)
        self.lengths, self.boxes, self.unread, self.remarks = {}, {}, {}, set()

    def place(self, p):
        return self.turn * p + self.shift

    def add(self, key, curve):
        """`curve` is in mm, before scale, turn and shift."""
        if isinstance(curve, Ellipse):
            curve = Ellipse(self.place(curve.centre), self.turn * curve.major, self.turn * curve.minor, curve.start,
                            curve.sweep)
        elif isinstance(curve, Line):
            curve = Line(*map(self.place, curve.ends))
        elif isinstance(curve, Bezier):
            curve = Bezier(*map(self.place, curve.points))
        else:
            point, derivative = curve.point, curve.derivative
            curve = Sampled(lambda u: self.place(point(u)), lambda u: self.turn * derivative(u))
        length = curve.length()
        if length <= NOTHING_MM:
            return
        self.lengths.setdefault(key, []).append(length)
        box = self.boxes.setdefault(key, [math.inf, math.inf, -math.inf, -math.inf])
        for p in curve.reach():
            box[:] = min(box[0], p.real), min(box[1], p.imag), max(box[2], p.real), max(box[3], p.imag)

    def skip(self, key, what):
        """Something of which it is not known whether it draws lines."""
        self.unread[key, what] = self.unread.get((key, what), 0) + 1
