# SPDX-License-Identifier: Apache-2.0
"""How time and memory grow with the size of a job: units on the web, lines of a drawing, edges of a recording.

Each size is a process of its own, run once: what counts is the slope over four decades, not the last per cent. The slope is that of a
straight line through the logarithms of the larger half of the sizes, where what a run costs at any size no longer tells.
"""
import collections
import math
import os
import re
import shutil
import sys

# unit: of values. one value for each size.
Curve = collections.namedtuple("Curve", "what unit sizes values")
# name: of the file. across: what the sizes are.
Plot = collections.namedtuple("Plot", "name title across curves")

UNITS = (1, 3, 10, 30, 100)
LINES_READ = (10, 100, 1000, 10000, 100000)
EDGES = (10**5, 10**6, 10**7, 10**8, 10**9)
BYTES_PER_EDGE = 32  # Of the file, and of what is spilled while it is written and judged, with something to spare.
LINE_MM = 1.6
PITCH_MM = 3.0


def slope(curve):
    """Power of the size with which a curve grows at its larger sizes."""
    points = [(math.log(size), math.log(value)) for size, value in zip(curve.sizes, curve.values)]
    points = points[len(points) // 2:] if len(points) > 3 else points
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def square_of_lines(count):
    """A drawing of short lines along y, side by side in rows, in mm."""
    side = math.ceil(math.sqrt(count))
    extent = side * PITCH_MM
    paths = [f"M{(i % side + 0.5) * PITCH_MM:.3f},{(i // side + 0.25) * PITCH_MM:.3f} v{LINE_MM}" for i in range(count)]
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{extent}mm" height="{extent}mm" viewBox="0 0 {extent} {extent}">\n'
            f'<path fill="none" stroke="#000" d="{" ".join(paths)}"/>\n</svg>\n')


def scenario_of(base, folder, name, changes):
    """A scenario that extends a shipped one, in a folder of its own."""
    path = os.path.join(folder, name + ".yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"extends: {base}\nname: {name}\n" + changes)
    return path


def measured(process, kerfbench, folder, scenario, command):
    said, wall_s, cpu_s, peak_mib = process(kerfbench, *command, scenario,
                                            *(("--timing", "--no-pictures", "--results-dir", folder) if command[0] == "run" else ()))
    simulated = re.search(r"in all for ([\d.]+) simulated s", said)
    return {"wall": wall_s, "cpu": cpu_s, "peak": peak_mib, "simulated": float(simulated.group(1)) if simulated else 0.0}


def curves(sizes, figures):
    of = lambda key: [figure[key] for figure in figures]
    return [Curve("processor", "s", sizes, of("cpu")), Curve("peak of memory", "MiB", sizes, of("peak"))]


def units_plot(process, kerfbench, scenarios, folder):
    label = os.path.join(scenarios, "native", "label-on-belt.yaml")
    units = [measured(process, kerfbench, folder, scenario_of(label, folder, f"units-{n}", (
        f"print: {{units: {n}}}\ntime_limit_s: {20 + 2 * n}\n")), ("run", "--twin", "fast")) for n in UNITS]
    return Plot("units", "Units of a label on the web, from drawing to report", "units",
                [*curves(UNITS, units), Curve("the job itself", "s", UNITS, [u["simulated"] for u in units])])


def lines_plot(process, kerfbench, folder):
    read = []
    for n in LINES_READ:
        drawing = os.path.join(folder, f"lines-{n}.svg")
        with open(drawing, "w", encoding="utf-8") as file:
            file.write(square_of_lines(n))
        read.append(measured(process, kerfbench, folder, drawing, ("lint",)))
    return Plot("lines", "Lines of a drawing, read and checked", "lines", curves(LINES_READ, read))


def edges_plot(process, kerfbench, folder):
    """Recordings of as many edges as the disk has room for."""
    program = os.path.join(os.path.dirname(kerfbench), "kerfbench-edges")
    recording = os.path.join(folder, "edges.vcd")
    sizes, read = [], []
    for n in EDGES:
        if n * BYTES_PER_EDGE > shutil.disk_usage(folder).free:
            print(f"benchmark: the disk has no room for {n:.0e} edges", file=sys.stderr, flush=True)
            break
        process(program, "write", str(n), recording)
        said, _, cpu_s, peak_mib = process(program, "judge", recording)
        sizes.append(int(re.search(r"(\d+) edges$", said.strip()).group(1)))
        read.append({"cpu": cpu_s, "peak": peak_mib})
        os.remove(recording)
    return Plot("edges", "Edges of a recording, read, checked and judged", "edges", curves(sizes, read))


def plots(process, kerfbench, scenarios, folder):
    """All plots. `process` runs a program: what it says, wall s, CPU s, peak MiB."""
    return [units_plot(process, kerfbench, scenarios, folder), lines_plot(process, kerfbench, folder),
            edges_plot(process, kerfbench, folder)]


COLOURS = ("#1f5fa8", "#b3541e", "#3a7d34", "#7a3d8f")
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 640, 400, 64, 200, 36, 48


def decades(values):
    return math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)) + 1e-9)


def svg_of(plot):
    """Both axes logarithmic; a line of n log n to compare with."""
    x0, x1 = decades([size for curve in plot.curves for size in curve.sizes])
    y0, y1 = decades([value for curve in plot.curves for value in curve.values])
    x1, y1 = max(x1, x0 + 1), max(y1, y0 + 1)

    def at(size, value):
        return (LEFT + (WIDTH - LEFT - RIGHT) * (math.log10(size) - x0) / (x1 - x0),
                HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * (math.log10(value) - y0) / (y1 - y0))

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" '
           'font-family="sans-serif" font-size="12">', '<rect width="100%" height="100%" fill="#fff"/>',
           f'<text x="{LEFT}" y="20" font-size="14">{plot.title}</text>']
    for k in range(x0, x1 + 1):
        x, _ = at(10.0 ** k, 10.0 ** y0)
        out += [f'<path d="M{x:.1f},{TOP} V{HEIGHT - BOTTOM}" stroke="#ddd"/>',
                f'<text x="{x:.1f}" y="{HEIGHT - BOTTOM + 16}" text-anchor="middle">{10 ** k:g}</text>']
    for k in range(y0, y1 + 1):
        _, y = at(10.0 ** x0, 10.0 ** k)
        out += [f'<path d="M{LEFT},{y:.1f} H{WIDTH - RIGHT}" stroke="#ddd"/>',
                f'<text x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">{10.0 ** k:g}</text>']
    out.append(f'<text x="{(LEFT + WIDTH - RIGHT) / 2}" y="{HEIGHT - 12}" text-anchor="middle">{plot.across}</text>')
    for i, curve in enumerate(plot.curves):
        points = [at(size, value) for size, value in zip(curve.sizes, curve.values)]
        colour = COLOURS[i % len(COLOURS)]
        path = " L".join(f"{x:.1f},{y:.1f}" for x, y in points)
        out.append(f'<path d="M{path}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in points]
        out.append(f'<text x="{WIDTH - RIGHT + 8}" y="{TOP + 14 + 34 * i}" fill="{colour}">{curve.what}, {curve.unit}</text>')
        out.append(f'<text x="{WIDTH - RIGHT + 8}" y="{TOP + 29 + 34 * i}" fill="{colour}">∝ size^{slope(curve):.2f}</text>')
    return "\n".join([*out, "</svg>", ""])
