# SPDX-License-Identifier: Apache-2.0
"""SVG: paths, shapes, transforms, colours and viewports by svgelements (package python3-svgelements). That library's own
walk does not know forward uses, switch and symbols, so the walk and what is shown follow the standard here."""
import math
import re
import xml.etree.ElementTree as xml
from copy import copy

import svgelements

from witness_curves import Bezier, Ellipse, Line
from witness_style import StyleSheet

READER = "svgelements " + getattr(svgelements, "__version__", "1.7")
SVG = "{http://www.w3.org/2000/svg}"
INKSCAPE = "{http://www.inkscape.org/namespaces/inkscape}"
SODIPODI = "{http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd}"
HREF = "{http://www.w3.org/1999/xlink}href"
CLOSING_MM = 1e-4  # A path that ends so near its start is closed: decimals are rounded.
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
PHYSICAL = {"mm": 25.4, "cm": 2.54, "in": 1.0, "pt": 72.0, "pc": 6.0}
SHAPES = {"path", "rect", "circle", "ellipse", "line", "polyline", "polygon"}
HIDDEN = {"defs", "symbol", "metadata", "title", "desc", "style", "clipPath", "mask", "pattern", "marker", "filter",
          "linearGradient", "radialGradient", "script", "view"}
NO_LINES = {"text", "image", "foreignObject", "flowRoot", "video", "audio"}


def px_per_inch(root, prolog):
    """The program's: 72 of Illustrator, 90 of Inkscape up to 0.91 and of Sodipodi, 96 of CSS."""
    if "Adobe Illustrator" in prolog:
        return 72.0
    version = root.get(INKSCAPE + "version")
    if version is None:
        return 90.0 if root.get(SODIPODI + "version") else 96.0
    found = re.match(r"(\d+)(?:\.(\d+))?", version)
    return 90.0 if found and int(found[1]) == 0 and int(found[2] or 0) <= 91 else 96.0


class State:
    """What an element gets from those around it."""

    def __init__(self, matrix, size):
        self.matrix, self.size, self.labels = matrix, size, ()
        self.style = {"stroke": "none", "color": "#000000", "stroke-width": "1", "stroke-opacity": "1",
                      "stroke-dasharray": "none", "visibility": "visible"}
        self.faded = False


class SvgReader:
    def __init__(self, path, sheet, told_mm):
        self.sheet, self.told_mm = sheet, told_mm
        text = open(path, "rb").read().decode("utf-8-sig", "replace")
        self.root = xml.parse(path).getroot()
        self.ppi = px_per_inch(self.root, text[:max(0, re.search(r"<(?:\w+:)?svg\b", text).start())])
        self.by_id = {}
        self.styles = StyleSheet()
        for element in self.root.iter():
            self.by_id.setdefault(element.get("id"), element)
            if element.tag == SVG + "style":
                self.styles.add("".join(element.itertext()))
        for selector in self.styles.unread:
            sheet.remarks.add(f"style selector {selector}")

    def length(self, element, name, whole):
        """In user units; None where it is missing or auto."""
        text = (element.get(name) or "").strip()
        if not text or text == "auto":
            return None
        found = re.fullmatch(rf"({NUMBER})\s*(px|mm|cm|in|pt|pc|%)?", text)
        if not found:
            raise ValueError(f"{name} is no length: {text}")
        value = float(found[1])
        if found[2] == "%":
            return value * whole / 100
        return value * self.ppi / PHYSICAL[found[2]] if found[2] in PHYSICAL else value

    @staticmethod
    def view_box(element):
        text = element.get("viewBox")
        return [float(v) for v in re.findall(NUMBER, text)] if text else None

    def page(self):
        """The root's matrix to mm, y up from the bottom of the page, and the size of 100 %."""
        root, box = self.root, self.view_box(self.root)
        width, height = (None if (root.get(n) or "").endswith("%") else self.length(root, n, 0)
                         for n in ("width", "height"))
        if box and width is None and height is None:
            width, height = box[2], box[3]
        elif box and width is None:
            width = height * box[2] / box[3]
        elif box and height is None:
            height = width * box[3] / box[2]
        width, height = width or 0.0, height or 0.0
        inside = box or [0.0, 0.0, width, height]
        if self.told_mm:
            mm = self.told_mm
            matrix = svgelements.Matrix(mm, 0, 0, -mm, -mm * inside[0], mm * (inside[1] + inside[3]))
        else:
            mm = 25.4 / self.ppi
            matrix = self.fitted(root, width, height) * svgelements.Matrix(mm, 0, 0, -mm, 0, mm * height)
        return State(matrix, (inside[2], inside[3])), mm

    def fitted(self, element, width, height):
        box = self.view_box(element)
        if not box:
            return svgelements.Matrix()
        return svgelements.Matrix(svgelements.Viewbox.viewbox_transform(
            0.0, 0.0, width, height, *box, element.get("preserveAspectRatio")))

    def read(self):
        state, mm = self.page()
        state = self.enter(self.root, state)
        if state:
            self.children(self.root, state)
        return mm

    @staticmethod
    def name(element):
        tag = element.tag
        if not isinstance(tag, str):
            return "!"
        return tag[len(SVG):] if tag.startswith(SVG) else ("" if tag.startswith("{") else tag)

    @staticmethod
    def applies(element):
        if element.get("requiredExtensions") is not None:
            return False
        languages = element.get("systemLanguage")
        return languages is None or any(re.fullmatch("en(-.*)?", one.strip().lower()) for one in languages.split(","))

    def enter(self, element, outer):
        """The state of an element, or None where it is not displayed."""
        if not self.applies(element):
            return None
        own = self.styles.of(element, self.name(element))
        if own.get("display", "").lower() == "none":
            return None
        state = copy(outer)
        state.style = dict(outer.style)
        for name in state.style:
            value = own.get(name, "inherit")
            keeps = ("inherit", "unset", "currentcolor") if name == "color" else ("inherit", "unset")
            if value.lower() not in keeps:
                state.style[name] = value
        state.faded = outer.faded or is_zero(own.get("opacity", "1"))
        if own.get("transform", "none") != "none":
            state.matrix = svgelements.Matrix(own["transform"]) * outer.matrix
        for hiding in ("clip-path", "mask"):
            if own.get(hiding, "none") != "none":
                self.sheet.remarks.add(hiding)
        if element.get(INKSCAPE + "groupmode") == "layer":
            state.labels = outer.labels + ((element.get(INKSCAPE + "label") or "").encode(),)
        return state

    def children(self, element, state):
        for child in element:
            self.element(child, state)

    def element(self, element, outer):
        name = self.name(element)
        if name in HIDDEN or name in ("", "!"):
            return
        state = self.enter(element, outer)
        if state is None:
            return
        if name in ("g", "a"):
            self.children(element, state)
        elif name == "switch":
            shown = [c for c in element if self.name(c) not in HIDDEN | {"", "!"} and self.applies(c)]
            for child in shown[:1]:
                self.element(child, state)
        elif name == "svg":
            self.nested(element, element, state)
        elif name == "use":
            self.use(element, state)
        elif state.style["visibility"].lower() not in ("visible", "initial"):
            return
        elif name in SHAPES:
            self.shape(element, name, state)
        elif name not in NO_LINES:
            self.sheet.skip(self.key(state), name)

    def moved(self, element, state):
        x, y = (self.length(element, n, s) or 0.0 for n, s in zip("xy", state.size))
        state.matrix = svgelements.Matrix(1, 0, 0, 1, x, y) * state.matrix

    def nested(self, element, sized, state):
        """An svg or symbol with a viewport of its own; what overflows it is not followed."""
        if self.name(element) == "svg":
            self.moved(element, state)
        width, height = (self.length(sized if sized.get(n) else element, n, s)
                         for n, s in zip(("width", "height"), state.size))
        width = state.size[0] if width is None else width
        height = state.size[1] if height is None else height
        if width == 0 or height == 0:
            return
        box = self.view_box(element)
        state.matrix = self.fitted(element, width, height) * state.matrix
        state.size = (box[2], box[3]) if box else (width, height)
        self.children(element, state)

    def use(self, element, state):
        target = self.by_id.get((element.get("href") or element.get(HREF) or "").strip().lstrip("#"))
        if target is None:
            return
        self.moved(element, state)
        if self.name(target) not in ("symbol", "svg"):
            self.element(target, state)
            return
        inner = self.enter(target, state)
        if inner is not None:
            self.nested(target, element, inner)

    def key(self, state):
        stroke = state.style["stroke"].strip()
        if stroke.lower() == "currentcolor":
            stroke = state.style["color"]
        if stroke.lower() in ("none", "initial", "transparent"):
            colour = "none"
        else:
            colour = svgelements.Color(stroke)
            colour = stroke if colour.value is None else f"#{colour.red:02x}{colour.green:02x}{colour.blue:02x}"
        dashed = any(c in "123456789" for c in state.style["stroke-dasharray"])
        return (state.labels, (colour,), "dashed" if dashed else "continuous", True)

    def shape(self, element, name, state):
        if state.faded or is_zero(state.style["stroke-opacity"]) or is_zero(state.style["stroke-width"]):
            return
        key = self.key(state)
        matrix = state.matrix

        def linear(p):
            return complex(matrix.a * p.real + matrix.c * p.imag, matrix.b * p.real + matrix.d * p.imag)

        def place(p):
            return linear(complex(p.x, p.y)) + complex(matrix.e, matrix.f)

        for segment in self.path(element, name, state):
            if isinstance(segment, svgelements.Move) or segment.start is None or segment.end is None:
                continue
            if isinstance(segment, (svgelements.Line, svgelements.Close)):
                line = Line(place(segment.start), place(segment.end))
                if name == "path" and isinstance(segment, svgelements.Line) or line.length() > CLOSING_MM:
                    self.sheet.add(key, line)
            elif isinstance(segment, svgelements.QuadraticBezier):
                self.sheet.add(key, Bezier(place(segment.start), place(segment.control), place(segment.end)))
            elif isinstance(segment, svgelements.CubicBezier):
                self.sheet.add(key, Bezier(*map(place, (segment.start, segment.control1, segment.control2,
                                                        segment.end))))
            else:
                centre = complex(segment.center.x, segment.center.y)
                major = complex(segment.prx.x, segment.prx.y) - centre
                minor = complex(segment.pry.x, segment.pry.y) - centre
                self.sheet.add(key, Ellipse(place(segment.center), linear(major), linear(minor),
                                            segment.get_start_t(), segment.sweep))

    def path(self, element, name, state):
        """The element as a path of the library's, in user units."""
        width, height = state.size
        whole = dict.fromkeys(("x", "rx", "width", "cx", "x1", "x2"), width)
        whole["r"] = math.hypot(width, height) / math.sqrt(2)

        def number(attribute):
            return self.length(element, attribute, whole.get(attribute, height))

        if name == "path":
            return svgelements.Path(element.get("d") or "")
        if name == "rect":
            rx, ry = number("rx"), number("ry")
            size = {"x": number("x") or 0.0, "y": number("y") or 0.0, "width": number("width") or 0.0,
                    "height": number("height") or 0.0}
            rx, ry = (ry if rx is None else rx) or 0.0, (rx if ry is None else ry) or 0.0
            return svgelements.Path(svgelements.Rect(**size, rx=min(rx, size["width"] / 2),
                                                     ry=min(ry, size["height"] / 2)))
        if name == "circle":
            r = number("r") or 0.0
            return svgelements.Path(svgelements.Ellipse(cx=number("cx") or 0.0, cy=number("cy") or 0.0, rx=r, ry=r))
        if name == "ellipse":
            rx, ry = number("rx"), number("ry")
            return svgelements.Path(svgelements.Ellipse(cx=number("cx") or 0.0, cy=number("cy") or 0.0,
                                                        rx=(ry if rx is None else rx) or 0.0,
                                                        ry=(rx if ry is None else ry) or 0.0))
        if name == "line":
            x1, y1, x2, y2 = (number(n) or 0.0 for n in ("x1", "y1", "x2", "y2"))
            return svgelements.Path(svgelements.SimpleLine(x1, y1, x2, y2))
        numbers = [float(v) for v in re.findall(NUMBER, element.get("points") or "")]
        points = list(zip(numbers[::2], numbers[1::2]))
        return svgelements.Path((svgelements.Polygon if name == "polygon" else svgelements.Polyline)(*points))


def is_zero(text):
    found = re.match(rf"\s*({NUMBER})", text)
    return bool(found) and float(found[1]) == 0


def read_svg(path, sheet, told_mm, _page):
    """Returns the millimetres of a unit that is told, else those of a px."""
    return READER, SvgReader(path, sheet, told_mm).read()
