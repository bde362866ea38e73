# SPDX-License-Identifier: Apache-2.0
"""Drawings written by other people's programs. Each writer makes drawing number n in a folder, from shapes that
are drawn at random from n alone, and returns its path, the unit that
the reader has to be told (or nothing), and the millimetres of a unit; a program that is not installed raises Absent."""
import importlib
import math
import random
import shutil
import subprocess

MM_PER_PX = 25.4 / 96  # Of svgelements, where a file gives its size in mm, cm, in or pt.
LAYERS = ("CUT", "CREASE", "PERF")
STROKES = {"CUT": "#ff0000", "CREASE": "#0000ff", "PERF": "#00ffff"}
RGB = {"CUT": (1, 0, 0), "CREASE": (0, 0, 1), "PERF": (0, 1, 1)}


class Absent(Exception):
    """A program or library that a writer needs."""


def library(name):
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise Absent(f"Python's {name.split('.')[0]}") from error


def program(name):
    path = shutil.which(name)
    if path is None:
        raise Absent(name)
    return path


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=120)


class Shapes:
    """Numbers of a seeded generator, in the ranges of a sheet of 200 x 150 mm."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.layers = [self.random.choice(LAYERS) for _ in range(6)]

    def point(self):
        return (self.random.uniform(20, 180), self.random.uniform(20, 130))

    def number(self, low, high):
        return self.random.uniform(low, high)

    def points(self, count):
        return [self.point() for _ in range(count)]


# DXF

def fill_dxf(space, shapes, can_ellipse):
    for layer in shapes.layers:
        look = {"layer": layer}
        space.add_line(shapes.point(), shapes.point(), dxfattribs=look)
        space.add_circle(shapes.point(), shapes.number(1, 15), dxfattribs=look)
        space.add_arc(shapes.point(), shapes.number(1, 15), shapes.number(0, 360), shapes.number(0, 360),
                      dxfattribs=look)
        vertices = [(*p, shapes.number(-1, 1)) for p in shapes.points(5)]
        if not can_ellipse:
            space.add_polyline2d(vertices, format="xyb", close=True, dxfattribs=look)
            continue
        space.add_lwpolyline(vertices, format="xyb", close=True, dxfattribs=look)
        angle = shapes.number(0, 6)
        reach = shapes.number(5, 15)
        space.add_ellipse(shapes.point(), (reach * math.cos(angle), reach * math.sin(angle)),
                          shapes.number(0.2, 1), shapes.number(0, 6), shapes.number(0, 6), dxfattribs=look)
        space.add_open_spline(shapes.points(7), degree=3, dxfattribs=look)


def by_ezdxf(folder, n):
    ezdxf = library("ezdxf")
    version = ("R12", "R2000", "R2004", "R2007", "R2010", "R2013", "R2018")[n % 7]
    shapes = Shapes(n)
    drawing = ezdxf.new(version)
    unit, mm_per_unit = ((4, 1.0), (1, 25.4), (5, 10.0))[n % 3 if version != "R12" else 0]
    drawing.header["$INSUNITS"] = unit
    for layer in LAYERS:
        drawing.layers.add(layer)
    can_ellipse = version != "R12"
    fill_dxf(drawing.modelspace(), shapes, can_ellipse)
    part = drawing.blocks.new("PART", base_point=(3, 4))
    part.add_line((0, 0), shapes.point(), dxfattribs={"layer": "CUT"})
    part.add_arc((5, 5), 4, 20, 200, dxfattribs={"layer": "0"})
    whole = drawing.blocks.new("WHOLE")
    whole.add_blockref("PART", (10, 10), dxfattribs={"layer": "CREASE", "rotation": 30, "xscale": -1})
    for _ in range(3):
        scale = shapes.number(0.2, 0.8)
        drawing.modelspace().add_blockref("WHOLE", shapes.point(), dxfattribs={
            "layer": "PERF", "rotation": shapes.number(0, 360), "xscale": scale, "yscale": -scale})
    path = folder / f"ezdxf-{n}.dxf"
    drawing.saveas(path)
    return path, None, mm_per_unit


def by_r12writer(folder, n):
    writer = library("ezdxf.addons.r12writer")
    shapes = Shapes(100 + n)
    path = folder / f"r12writer-{n}.dxf"
    with writer.r12writer(str(path)) as dxf:
        for layer in shapes.layers:
            dxf.add_line(shapes.point(), shapes.point(), layer=layer)
            dxf.add_circle(shapes.point(), shapes.number(1, 15), layer=layer)
            dxf.add_arc(shapes.point(), shapes.number(1, 15), shapes.number(0, 360), shapes.number(0, 360), layer=layer)
            vertices = [(*p, shapes.number(-1, 1)) for p in shapes.points(4)]
            dxf.add_polyline_2d(vertices, format="xyb", closed=True, layer=layer)
    return path, None, 1.0


def openscad(folder, n, kind):
    shapes = Shapes(200 + n)
    lines = []
    for _ in range(4):
        x, y = shapes.point()
        lines.append(f"translate([{x}, {y}]) difference() {{ square([{shapes.number(5, 30)}, 25]); "
                     f"translate([3, 4]) circle(r={shapes.number(1, 8)}, $fn={16 + n}); }}")
        x, y = shapes.point()
        lines.append(f"translate([{x}, {y}]) rotate({shapes.number(0, 90)}) circle(d={shapes.number(2, 20)}, $fn=24);")
    source = folder / f"openscad-{kind}-{n}.scad"
    source.write_text("union() {\n" + "\n".join(lines) + "\n}\n")
    path = source.with_suffix("." + kind)
    run(program("openscad"), "-o", str(path), str(source))
    return path, None, 1.0 if kind == "dxf" else MM_PER_PX


def by_openscad_dxf(folder, n):
    return openscad(folder, n, "dxf")


def by_openscad_svg(folder, n):
    return openscad(folder, n, "svg")


# SVG

def svgwrite_drawing(path, n):
    svgwrite = library("svgwrite")
    shapes = Shapes(300 + n)
    drawing = svgwrite.Drawing(str(path), size=("200mm", "150mm"), viewBox="0 0 400 300" if n % 2 else "0 0 200 150")
    part = drawing.defs.add(drawing.g(id="part", fill="none"))
    part.add(drawing.path(d="M0 0 q 5 8 10 0 t 10 0 a 6 3 20 1 0 5 5 z"))
    for index, layer in enumerate(shapes.layers):
        group = drawing.add(drawing.g(fill="none", stroke=STROKES[layer]))
        if index % 3 == 0:
            group.rotate(shapes.number(-30, 30), center=(100, 75))
        group.add(drawing.line(shapes.point(), shapes.point()))
        group.add(drawing.circle(shapes.point(), shapes.number(1, 15)))
        group.add(drawing.ellipse(shapes.point(), (shapes.number(1, 15), shapes.number(1, 9))))
        group.add(drawing.rect(shapes.point(), (shapes.number(5, 20), 12), rx=shapes.number(0.5, 4)))
        group.add(drawing.polygon(shapes.points(4)))
        a, b, c, d = shapes.points(4)
        group.add(drawing.path(d=f"M{a[0]} {a[1]} C {b[0]} {b[1]} {c[0]} {c[1]} {d[0]} {d[1]} S 60 70 {a[0]} {a[1]}"))
        group.add(drawing.use(part, insert=shapes.point()))
    drawing.save()


def by_svgwrite(folder, n):
    path = folder / f"svgwrite-{n}.svg"
    svgwrite_drawing(path, n)
    return path, None, MM_PER_PX


def by_inkscape(folder, n):
    inkscape = program("inkscape")
    source = folder / f"for-inkscape-{n}.svg"
    svgwrite_drawing(source, 50 + n)
    path = folder / f"inkscape-{n}.svg"
    run(inkscape, "--export-plain-svg" if n % 2 else "--export-type=svg", f"--export-filename={path}", str(source))
    return path, None, MM_PER_PX


def by_cairo(folder, n):
    cairo = library("cairo")
    shapes = Shapes(400 + n)
    path = folder / f"cairo-{n}.svg"
    surface = cairo.SVGSurface(str(path), 200 * 72 / 25.4, 150 * 72 / 25.4)
    context = cairo.Context(surface)
    context.scale(72 / 25.4, 72 / 25.4)
    context.set_line_width(0.2)
    for layer in shapes.layers:
        context.set_source_rgb(*RGB[layer])
        context.move_to(*shapes.point())
        context.line_to(*shapes.point())
        context.curve_to(*shapes.point(), *shapes.point(), *shapes.point())
        context.close_path()
        context.stroke()
        context.arc(*shapes.point(), shapes.number(1, 12), 0, shapes.number(1, 6))
        context.stroke()
    surface.finish()
    return path, None, MM_PER_PX


def by_pdftocairo(folder, n):
    pdftocairo = program("pdftocairo")
    canvas = library("reportlab.pdfgen.canvas")
    shapes = Shapes(500 + n)
    source = folder / f"reportlab-{n}.pdf"
    page = canvas.Canvas(str(source), pagesize=(600, 450))
    for layer in shapes.layers:
        page.setStrokeColorRGB(*RGB[layer])
        page.line(*shapes.point(), *shapes.point())
        page.bezier(*shapes.point(), *shapes.point(), *shapes.point(), *shapes.point())
        page.rect(*shapes.point(), shapes.number(5, 40), 30)
    page.save()
    path = source.with_suffix(".svg")
    run(pdftocairo, "-svg", str(source), str(path))
    return path, None, MM_PER_PX


def by_reportlab(folder, n):
    graphics = library("reportlab.graphics.shapes")
    render = library("reportlab.graphics.renderSVG")
    colors = library("reportlab.lib.colors")
    shapes = Shapes(600 + n)
    drawing = graphics.Drawing(600, 450)
    for layer in shapes.layers:
        look = {"strokeColor": colors.Color(*RGB[layer]), "fillColor": None}
        drawing.add(graphics.Line(*shapes.point(), *shapes.point(), strokeColor=look["strokeColor"]))
        drawing.add(graphics.Circle(*shapes.point(), shapes.number(1, 15), **look))
        drawing.add(graphics.Rect(*shapes.point(), shapes.number(3, 30), 9, **look))
        drawing.add(graphics.Polygon([c for p in shapes.points(4) for c in p], **look))
    path = folder / f"reportlab-{n}.svg"
    render.drawToFile(drawing, str(path))
    return path, "pt", 25.4 / 72


def by_matplotlib(folder, n):
    matplotlib = library("matplotlib")
    matplotlib.use("svg")
    figures = library("matplotlib.figure")
    patches = library("matplotlib.patches")
    paths = library("matplotlib.path")
    shapes = Shapes(700 + n)
    figure = figures.Figure(figsize=(200 / 25.4, 150 / 25.4))
    figure.patch.set_visible(False)
    kinds = [paths.Path.MOVETO, paths.Path.CURVE4, paths.Path.CURVE4, paths.Path.CURVE4, paths.Path.LINETO,
             paths.Path.CURVE3, paths.Path.CURVE3]
    for layer in shapes.layers:
        points = [(x / 200, y / 150) for x, y in shapes.points(7)]
        figure.add_artist(patches.PathPatch(paths.Path(points, kinds), fill=False, edgecolor=RGB[layer],
                                            transform=figure.transFigure))
    path = folder / f"matplotlib-{n}.svg"
    figure.savefig(path)
    return path, None, MM_PER_PX


WRITERS = {"ezdxf": by_ezdxf, "r12writer": by_r12writer, "openscad_dxf": by_openscad_dxf,
           "openscad_svg": by_openscad_svg, "svgwrite": by_svgwrite, "cairo": by_cairo,
           "pdftocairo": by_pdftocairo, "reportlab": by_reportlab, "matplotlib": by_matplotlib,
           "inkscape": by_inkscape}
