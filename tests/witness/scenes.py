# SPDX-License-Identifier: Apache-2.0
"""What the kerf camera looks at, as text for POV-Ray: a sheet on the back light, the calibration target."""
import dataclasses
import math
import re

import slits

LIGHT = 235 / 255               # Grey of the back light.
TRANSMISSION = 0.12             # Of the board.
INK = 2 / 12                    # Of a printed mark, on top of the board's.
PAPER, BLACK = 220 / 255, 20 / 255


def turned(angle_deg, x, y):
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return c * x - s * y, s * x + c * y


@dataclasses.dataclass(frozen=True)
class Camera:
    """Looks down at z = 0, its middle at (0, 0), leaning about the picture's own x. Telecentric: with parallel rays.

    It is rolled about its axis, so that the edges of a sheet lie along no row or column of pixels: POV-Ray places such
    edges on 1/16 pixel.
    """
    size_px: tuple
    pitch_mm: float = 0.03
    height_mm: float = 300.0
    tilt_deg: float = 0.5
    roll_deg: float = -6.5
    telecentric: bool = False

    def text(self):
        tilt = math.radians(self.tilt_deg)
        down = (*turned(self.roll_deg, 0.0, -math.sin(tilt)), -math.cos(tilt))
        up = (*turned(self.roll_deg, 0.0, math.cos(tilt)), -math.sin(tilt))
        right = (*turned(self.roll_deg, 1.0, 0.0), 0.0)
        wide, tall = (n * self.pitch_mm for n in self.size_px)
        kind, distance = ("orthographic", 100.0) if self.telecentric else ("perspective", self.height_mm)
        ahead = 1.0 if self.telecentric else self.height_mm

        def times(length, of):
            return slits.vector(*(length * c for c in of))
        # Explicit vectors make it right-handed: of a camera that is not rolled, right is +x and up is +y.
        return (f"#version 3.7;\nglobal_settings {{ assumed_gamma 1.0 max_trace_level 30 adc_bailout 0 }}\n"
                f"#default {{ finish {{ ambient 0 diffuse 0 emission 1 }} }}\n"
                f"camera {{ {kind} location {times(-distance, down)}\n"
                f"  direction {times(ahead, down)} right {times(wide, right)} up {times(tall, up)} }}\n")

    def slope(self, place):
        """Of the ray that meets a place of z = 0: how far it goes in x and y for each mm downwards."""
        tilt = math.radians(self.tilt_deg)
        if self.telecentric:
            return turned(self.roll_deg, 0.0, -math.tan(tilt))
        over_mm = self.height_mm * math.cos(tilt)
        foot = turned(self.roll_deg, 0.0, self.height_mm * math.sin(tilt))
        return (place[0] - foot[0]) / over_mm, (place[1] - foot[1]) / over_mm


@dataclasses.dataclass(frozen=True)
class Board:
    """Board and kerf. Narrow is the bottom of the slit."""
    thickness_mm: float
    bottom_mm: float = 0.13
    top_mm: float = 0.13

    def half_light_mm(self):
        """Width where half of the light comes through, straight down (Beer's law over the wall that leans)."""
        share = math.log(0.5 * (1.0 + TRANSMISSION)) / math.log(TRANSMISSION)
        return self.bottom_mm + share * (self.top_mm - self.bottom_mm)


@dataclasses.dataclass(frozen=True)
class Lay:
    """How the sheet lies on the table."""
    turn_deg: float
    x_mm: float
    y_mm: float

    def place(self, point):
        x, y = turned(self.turn_deg, *point)
        return x + self.x_mm, y + self.y_mm


def board_scene(camera, sheet, board, lay):
    t = board.thickness_mm
    grey, dark = (f"rgb {slits.number(v)}" for v in (LIGHT, TRANSMISSION * LIGHT))
    text = camera.text() + f"plane {{ z, {slits.number(-0.5 - t - (0.0 if t else 10.0))} pigment {{ {grey} }} }}\nunion {{\n"
    if t:
        margin = 0.01           # Beyond both faces: no two surfaces lie in one plane.
        lean = 0.5 * (board.top_mm - board.bottom_mm) / t
        walls = slits.Walls(-t - margin, margin, 0.5 * board.bottom_mm - lean * margin, 0.5 * board.top_mm + lean * margin)
        a, b = sheet.half_size_mm
        text += f"difference {{ box {{ {slits.vector(-a, -b, -t)}, {slits.vector(a, b, 0)} }}\n"
        text += slits.union(slits.solids(walls, sheet))
        fade = slits.number(t / math.log(1.0 / TRANSMISSION))
        text += ("pigment { rgbt 1 } finish { ambient 0 diffuse 0 emission 0 }\n"
                 f"interior {{ ior 1 fade_power 1001 fade_distance {fade} fade_color rgb 0 }} }}\n")
    else:
        # Infinitely thin: slits that shine on a plane that shines less. Bounding boxes are single precision: not closer.
        walls = slits.Walls(-2e-4, 0.0, 0.5 * board.bottom_mm, 0.5 * board.bottom_mm)
        text += f"plane {{ z, -1e-3 pigment {{ {dark} }} }}\n" + slits.union(slits.solids(walls, sheet), f"pigment {{ {grey} }}")
    for x, y in sheet.marks:
        text += (f"disc {{ {slits.vector(x, y, 1e-4)}, z, {slits.number(0.5 * sheet.mark_mm)} "
                 f"pigment {{ rgb 0 transmit {slits.number(INK)} }} finish {{ emission 0 }} }}\n")
    return text + f"rotate {slits.number(lay.turn_deg)}*z translate {slits.vector(lay.x_mm, lay.y_mm, 0)} }}\n"


@dataclasses.dataclass(frozen=True)
class View:
    """A pose of the target: turned in its own plane, then leaning about an axis of that plane, then shifted."""
    turn_deg: float
    lean_deg: float = 0.0
    axis_deg: float = 0.0
    x_mm: float = 0.0
    y_mm: float = 0.0
    z_mm: float = 0.0


@dataclasses.dataclass(frozen=True)
class Target:
    """The printed target, from the SVG that the bench writes: rectangles, y down, upper left square at (0, 0)."""
    size_mm: tuple
    square_mm: float
    rectangles: tuple           # (x, y, wide, tall, black)

    def origin_mm(self, view):
        """Where the corner of the first square lies in a flat view."""
        x, y = turned(view.turn_deg, -0.5 * self.size_mm[0], 0.5 * self.size_mm[1])
        return x + view.x_mm, y + view.y_mm


RECTANGLE = re.compile(r"M(-?[\d.]+) (-?[\d.]+)h(-?[\d.]+)v(-?[\d.]+)h-?[\d.]+z")


def read_target(svg, description):
    """The rectangles of the pattern in their order, and the size that the description gives."""
    values = dict(re.findall(r"^(\w+): ([\d.]+)", description, re.M))
    size = tuple(int(values[key]) * float(values["square_mm"]) for key in ("columns", "rows"))
    rectangles = []
    for fill, data in re.findall(r'<path fill="#(000|fff)" d="([^"]*)"', svg):
        rectangles += [tuple(map(float, found)) + (fill == "000",) for found in RECTANGLE.findall(data)]
    if not rectangles:
        raise ValueError("no rectangle in the target's SVG")
    return Target(size, float(values["square_mm"]), tuple(rectangles))


def pixels_per_mm(target):
    """The coarsest raster that has every edge of the print on an edge of a pixel."""
    edges = {v for x, y, dx, dy, _ in target.rectangles for v in (x, y, x + dx, y + dy)}
    for per_mm in (n / target.square_mm for n in range(5, 201)):
        # The SVG has six digits.
        if all(abs(v * per_mm - round(v * per_mm)) < 5e-3 for v in edges):
            return per_mm
    raise ValueError("the target's print fits no raster")


def target_bitmap(target):
    """Rows of grey bytes."""
    per_mm = pixels_per_mm(target)
    wide, tall = (round(n * per_mm) for n in target.size_mm)
    rows = [bytearray([round(255 * PAPER)]) * wide for _ in range(tall)]
    for x, y, dx, dy, black in target.rectangles:
        left, right, top, bottom = (round(v * per_mm) for v in (x, x + dx, y, y + dy))
        for row in rows[top:bottom]:
            row[left:right] = bytes([round(255 * (BLACK if black else PAPER))]) * (right - left)
    return rows


def target_scene(camera, target, view, picture):
    """The target as a picture on a sheet of paper; `picture` is the bitmap's name in POV-Ray's folder."""
    wide, tall = target.size_mm
    pose = (f"translate {slits.vector(-0.5 * wide, 0.5 * tall, 0)} rotate {slits.number(view.turn_deg)}*z "
            f"rotate {slits.number(-view.axis_deg)}*z rotate {slits.number(view.lean_deg)}*x "
            f"rotate {slits.number(view.axis_deg)}*z translate {slits.vector(view.x_mm, view.y_mm, view.z_mm)}")
    return (camera.text() + "plane { z, -200 pigment { rgb 0.5 } }\nunion {\n"
            # A unit square in x, y is what image_map fills; its upper row lies at the larger y.
            f'box {{ <0,0,-1e-4>, <1,1,0> pigment {{ image_map {{ pgm "{picture}" gamma 1.0 once }} }} '
            f"scale {slits.vector(wide, tall, 1)} translate {slits.vector(0, -tall, 0)} }}\n"
            f"difference {{ box {{ {slits.vector(-10, -tall - 10, -1e-4)}, {slits.vector(wide + 10, 10, 0)} }} "
            f"box {{ {slits.vector(0, -tall, -1)}, {slits.vector(wide, 0, 1)} }} pigment {{ rgb {slits.number(PAPER)} }} }}\n"
            f"{pose} }}\n")
