#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Another reading of a PDF's strokes: by MuPDF's trace, with lengths and boxes of its own.

    mutool draw -F trace FILE.pdf 1 | pdf_witness.py

Prints a line for each colour, sorted by length: length and box in mm, y up from the bottom of the page.
"""
import math
import sys
import xml.etree.ElementTree as xml

MM = 25.4 / 72
# Gauss and Legendre's five points on [0, 1].
NODES = [(0.5 + s * x / 2, w / 2) for x, w in ((0.0, 128 / 225), (math.sqrt(5 - 2 * math.sqrt(10 / 7)) / 3, (322 + 13 * math.sqrt(70)) / 900),
                                             (math.sqrt(5 + 2 * math.sqrt(10 / 7)) / 3, (322 - 13 * math.sqrt(70)) / 900))
         for s in ((1,) if x == 0.0 else (1, -1))]


def bezier(p, t):
    u = 1 - t
    return tuple(u * u * u * a + 3 * u * u * t * b + 3 * u * t * t * c + t * t * t * d for a, b, c, d in zip(*p))


def speed(p, t):
    u = 1 - t
    return math.hypot(*(3 * (u * u * (b - a) + 2 * u * t * (c - b) + t * t * (d - c)) for a, b, c, d in zip(*p)))


class Colour:
    def __init__(self):
        self.length, self.points = 0.0, []

    def line(self, p, q):
        self.length += math.dist(p, q)
        self.points += [p, q]

    def curve(self, *p):
        pieces = 32
        self.length += sum(w * speed(p, (i + x) / pieces) for i in range(pieces) for x, w in NODES) / pieces
        self.points += [p[0], p[3]]
        for axis in (0, 1):
            a, b, c, d = (q[axis] for q in p)
            # Zeros of the derivative, by the formula of quadratic equations.
            qa, qb, qc = d - 3 * c + 3 * b - a, 2 * (c - 2 * b + a), b - a
            if abs(qa) < 1e-12:
                zeros = [-qc / qb] if qb else []
            else:
                root = qb * qb - 4 * qa * qc
                zeros = [(-qb + s * math.sqrt(root)) / (2 * qa) for s in (1, -1)] if root >= 0 else []
            self.points += [bezier(p, t) for t in zeros if 0 < t < 1]


def main():
    page = xml.fromstring(sys.stdin.read()).find('page')
    height = float(page.get('mediabox').split()[3])
    colours = {}
    for path in page.iter('stroke_path'):
        a, b, c, d, e, f = (float(v) for v in path.get('transform').split())
        place = lambda x, y: ((a * x + c * y + e) * MM, (height - (b * x + d * y + f)) * MM)
        colour = colours.setdefault((path.get('colorspace'), path.get('color')), Colour())
        at = start = (0.0, 0.0)
        for step in path:
            of = lambda n: place(float(step.get('x' + n)), float(step.get('y' + n)))
            if step.tag == 'moveto':
                at = start = of('')
            elif step.tag == 'lineto':
                colour.line(at, of(''))
                at = of('')
            elif step.tag == 'curveto':
                colour.curve(at, of('1'), of('2'), of('3'))
                at = of('3')
            elif step.tag == 'closepath':
                colour.line(at, start)
                at = start
            else:
                sys.exit(f'step {step.tag} is not known')
    for colour in sorted(colours.values(), key=lambda c: c.length):
        xs, ys = zip(*colour.points)
        print(f'{colour.length:.6f} {min(xs):.6f} {min(ys):.6f} {max(xs):.6f} {max(ys):.6f}')


if __name__ == '__main__':
    main()
