# SPDX-License-Identifier: Apache-2.0
"""Writes a large drawing, to measure reading and lint: large_drawing.py KIND COUNT FILE [--seed N].

FILE is a .dxf or an .svg, by its extension, with lines on the layer CUT or in red. KIND is
  squares  squares side by side, four lines each, whose ends meet;
  random   lines of at most 10 mm anywhere, five for each mm2 of a sheet of at most 1.4 m, whose ends meet nothing;
  hatch    long lines in two directions that cross each other, 45 and -45 degrees, on a square of 1 m;
  star     lines of unequal length from one centre outwards.
The same arguments write the same bytes.
"""
import argparse
import math
import random
import sys

SHEET_MM = 1000.0


def squares(count, _):
    side = math.ceil(math.sqrt(count / 4))
    pitch = min(12.0, SHEET_MM * 1.4 / side)
    edge = pitch / 1.2
    for i in range(count):
        x, y = (i // 4 % side) * pitch, (i // 4 // side) * pitch
        corners = ((x, y), (x + edge, y), (x + edge, y + edge), (x, y + edge), (x, y))
        yield *corners[i % 4], *corners[i % 4 + 1]


def short_random(count, draw):
    sheet = min(1400.0, max(10.0, math.sqrt(count) * 1.4))
    for _ in range(count):
        x, y = draw.uniform(0, sheet), draw.uniform(0, sheet)
        length, angle = draw.uniform(0.1, 10.0), draw.uniform(0, 2 * math.pi)
        yield x, y, x + length * math.cos(angle), y + length * math.sin(angle)


def hatch(count, _):
    """Lines of both families go from edge to edge of the square."""
    half = (count + 1) // 2
    for i in range(count):
        c = 2 * SHEET_MM * (i // 2 + (0.3, 0.6)[i % 2]) / half - SHEET_MM  # Where it meets the axis; no ends meet.
        x0, x1 = max(0.0, -c), min(SHEET_MM, SHEET_MM - c)
        yield (x0, x0 + c, x1, x1 + c) if i % 2 == 0 else (x0, SHEET_MM - x0 - c, x1, SHEET_MM - x1 - c)


def star(count, draw):
    for i in range(count):
        angle = 2 * math.pi * i / count
        r = draw.uniform(0.2, 0.5) * SHEET_MM
        yield 0.0, 0.0, r * math.cos(angle), r * math.sin(angle)


KINDS = {"squares": squares, "random": short_random, "hatch": hatch, "star": star}


def write_dxf(file, lines):
    file.write("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n")
    for x0, y0, x1, y1 in lines:
        file.write(f"0\nLINE\n8\nCUT\n10\n{x0:.6f}\n20\n{y0:.6f}\n30\n0.0\n11\n{x1:.6f}\n21\n{y1:.6f}\n31\n0.0\n")
    file.write("0\nENDSEC\n0\nEOF\n")


def write_svg(file, lines):
    file.write('<svg xmlns="http://www.w3.org/2000/svg" width="1400mm" height="1400mm" viewBox="0 0 1400 1400">\n')
    for x0, y0, x1, y1 in lines:
        file.write(f'<line stroke="#ff0000" x1="{x0:.6f}" y1="{y0:.6f}" x2="{x1:.6f}" y2="{y1:.6f}"/>\n')
    file.write("</svg>\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("count", type=int)
    parser.add_argument("file")
    parser.add_argument("--seed", type=int, default=1)
    told = parser.parse_args()
    writers = {"dxf": write_dxf, "svg": write_svg}
    writer = writers.get(told.file.rpartition(".")[2].lower())
    if writer is None or told.count < 1:
        parser.error("FILE is a .dxf or an .svg, COUNT at least 1")
    with open(told.file, "w", encoding="ascii") as file:
        writer(file, KINDS[told.kind](told.count, random.Random(told.seed)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
