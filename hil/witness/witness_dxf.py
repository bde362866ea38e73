# SPDX-License-Identifier: Apache-2.0
"""DXF by ezdxf (package python3-ezdxf): parsing, blocks, splines and extrusions are the library's own; what is shown and
how long a unit is follows from the format's description."""
import math

import ezdxf
from ezdxf import recover
from ezdxf.math import Vec3

from witness_curves import Bezier, Ellipse, Line, Sampled

READER = "ezdxf " + ezdxf.__version__
MM_OF_UNIT = {1: 25.4, 4: 1.0, 5: 10.0, 6: 1000.0}
NO_LINES = {"TEXT", "MTEXT", "RTEXT", "ARCALIGNEDTEXT", "POINT", "DIMENSION", "ARC_DIMENSION", "LARGE_RADIAL_DIMENSION",
            "LEADER", "MULTILEADER", "MLEADER", "TOLERANCE", "HATCH", "SOLID", "IMAGE", "WIPEOUT", "OLEFRAME", "OLE2FRAME",
            "PDFUNDERLAY", "DWFUNDERLAY", "DGNUNDERLAY", "ACAD_TABLE", "XLINE", "RAY", "ATTDEF", "ATTRIB", "VIEWPORT"}
CONTROL_POINT = 16  # Of a smoothed polyline, beside the points of the curve.


def header(path):
    """Integers of the header, as they are written: the library sets what a file leaves out."""
    found = {}
    with open(path, encoding="latin-1") as file:
        name = None
        for code, text in zip(file, file):
            code, text = code.strip(), text.strip()
            if code == "9":
                name = text
            elif code == "0" and text == "ENDSEC":
                break
            elif name in ("$INSUNITS", "$MEASUREMENT") and code == "70":
                found[name] = int(text)
    return found


def mm_per_unit(path):
    """$INSUNITS; without it, inches where $MEASUREMENT says English; the trade's millimetres otherwise."""
    told = header(path)
    unit = told.get("$INSUNITS")
    if unit is None:
        return 25.4 if told.get("$MEASUREMENT") == 0 else 1.0
    if unit == 0 and told.get("$MEASUREMENT") != 0:
        return 1.0
    if unit not in MM_OF_UNIT:
        raise ValueError(f"$INSUNITS {unit} does not say how long a unit is")
    return MM_OF_UNIT[unit]


def flat(vector, scale=1.0):
    vector = Vec3(vector)
    return scale * complex(vector.x, vector.y)


class Look:
    """What a block's parts inherit: layer 0, BYBLOCK."""

    def __init__(self, layer="0", colour="7", linetype="continuous"):
        self.layer, self.colour, self.linetype = layer, colour, linetype


class DxfReader:
    def __init__(self, path, sheet, scale):
        self.path, self.sheet, self.scale = path, sheet, scale
        try:
            self.drawing = ezdxf.readfile(path)
        except ezdxf.DXFStructureError:
            self.drawing, _ = recover.readfile(path)
        # Names as the file has them: those of older files are in a code page.
        self.encoding = "utf-8" if self.drawing.dxfversion >= "AC1021" else self.drawing.encoding

    def read(self):
        self.entities(self.drawing.modelspace(), Look(), is_in_block=False)

    def layer(self, name):
        try:
            return self.drawing.layers.get(name)
        except ezdxf.DXFTableEntryError:
            return None

    def look(self, entity, outer, is_in_block):
        own = entity.dxf
        layer = outer.layer if is_in_block and own.layer == "0" else own.layer
        of_layer = self.layer(layer)
        colour = own.get("color", 256)
        linetype = own.get("linetype", "BYLAYER")
        if own.hasattr("true_color"):
            colour = f"#{own.true_color & 0xffffff:06x}"
        elif colour == 0:
            colour = outer.colour
        elif colour != 256:
            colour = str(abs(colour))
        elif of_layer is None:
            colour = "7"
        elif of_layer.dxf.hasattr("true_color"):
            colour = f"#{of_layer.dxf.true_color & 0xffffff:06x}"
        else:
            colour = str(abs(of_layer.dxf.color))
        if linetype.upper() == "BYLAYER":
            linetype = "continuous" if of_layer is None else of_layer.dxf.linetype
        elif linetype.upper() == "BYBLOCK":
            linetype = outer.linetype
        return Look(layer, colour, linetype)

    def is_shown(self, entity, look):
        if entity.dxf.get("invisible", 0) == 1 or entity.dxf.get("paperspace", 0) == 1:
            return False
        of_layer = self.layer(look.layer)
        if of_layer is None:
            return True
        # The parts of a block on layers of their own are shown although its INSERT's layer is off.
        return not of_layer.is_frozen() and (entity.dxftype() == "INSERT" or not of_layer.is_off())

    def key(self, look):
        of_layer = self.layer(look.layer)
        plotted = of_layer is None or of_layer.dxf.get("plot", 1) != 0
        return ((look.layer.encode(self.encoding, "dxfreplace"),), (look.colour,), look.linetype, plotted)

    def entities(self, entities, outer, is_in_block):
        for entity in entities:
            kind = entity.dxftype()
            if kind in NO_LINES:
                continue
            look = self.look(entity, outer, is_in_block)
            if not self.is_shown(entity, look):
                continue
            if kind == "INSERT":
                copies = entity.multi_insert() if entity.mcount > 1 else [entity]
                for copy in copies:
                    self.entities(copy.virtual_entities(), look, is_in_block=True)
            elif kind in ("LWPOLYLINE", "POLYLINE"):
                self.polyline(entity, self.key(look))
            else:
                self.curve(entity, self.key(look))

    def polyline(self, entity, key):
        if entity.dxftype() == "POLYLINE":
            if entity.is_poly_face_mesh or entity.is_polygon_mesh:
                self.sheet.skip(key, "POLYLINE that is a mesh")
                return
            entity.vertices[:] = [v for v in entity.vertices if not v.dxf.get("flags", 0) & CONTROL_POINT]
            if len(entity.vertices) < 2:
                return
        elif len(entity) < 2:
            return
        for part in entity.virtual_entities():
            self.curve(part, key)

    def curve(self, entity, key):
        kind = entity.dxftype()
        scale = self.scale
        if kind == "LINE":
            self.sheet.add(key, Line(flat(entity.dxf.start, scale), flat(entity.dxf.end, scale)))
        elif kind == "ARC":
            self.sheet.add(key, self.arc(entity, entity.dxf.start_angle, entity.dxf.end_angle))
        elif kind == "CIRCLE":
            self.sheet.add(key, self.arc(entity, 0.0, 360.0))
        elif kind == "ELLIPSE":
            start = entity.dxf.start_param
            self.sheet.add(key, Ellipse(flat(entity.dxf.center, scale), flat(entity.dxf.major_axis, scale),
                                        flat(entity.minor_axis, scale), start, turn(start, entity.dxf.end_param)))
        elif kind == "SPLINE":
            for part in self.spline(entity):
                self.sheet.add(key, part)
        else:
            self.sheet.skip(key, kind)

    def arc(self, entity, start_deg, end_deg):
        """An arc with its extrusion undone by the library's own frame."""
        ocs = entity.ocs()
        radius = self.scale * entity.dxf.radius
        return Ellipse(flat(ocs.to_wcs(entity.dxf.center), self.scale), flat(ocs.to_wcs(Vec3(1, 0, 0)), radius),
                       flat(ocs.to_wcs(Vec3(0, 1, 0)), radius), math.radians(start_deg),
                       turn(math.radians(start_deg), math.radians(end_deg)))

    def spline(self, entity):
        tool = entity.construction_tool()
        if not tool.is_rational and tool.is_clamped and tool.degree <= 3:
            for part in tool.bezier_decomposition():
                yield Bezier(*[flat(p, self.scale) for p in part])
            return
        knots = tool.knots()
        inner = sorted(set(knots[tool.order - 1:len(knots) - tool.order + 1]))
        for low, high in zip(inner, inner[1:]):
            yield self.span(tool, low, high)

    def span(self, tool, low, high):
        """One smooth piece; its far end is the next one's start, so it ends a little before."""
        last = math.nextafter(high, low)

        def at(u):
            return min(low + u * (high - low), last)
        return Sampled(lambda u: flat(tool.point(at(u)), self.scale),
                       lambda u: flat(tool.derivative(at(u), 1)[1], self.scale * (high - low)))


def turn(start, end):
    """The counter-clockwise way from one angle to another; equal angles are a full turn."""
    sweep = math.fmod(end - start, 2 * math.pi)
    return sweep if sweep > 1e-12 else sweep + 2 * math.pi


def read_dxf(path, sheet, told_mm, _page):
    """Returns the millimetres of a unit: those that are told, or by the file."""
    scale = told_mm or mm_per_unit(path)
    DxfReader(path, sheet, scale).read()
    return READER, scale
