# SPDX-License-Identifier: Apache-2.0
"""PDF by MuPDF's trace of the strokes of a page (package mupdf-tools). Its numbers are of single precision. It
knows the names of layers and inks, and no processing steps."""
import os
import re
import subprocess
import xml.etree.ElementTree as xml

from witness_curves import Bezier, Line

MUTOOL = "/usr/bin/mutool"
MM = 25.4 / 72
if not os.access(MUTOOL, os.X_OK):
    raise ImportError("mutool")


def hexadecimal(red, green, blue):
    return "#" + "".join(f"{round(255 * min(max(c, 0.0), 1.0)):02x}" for c in (red, green, blue))


def colours(stroke):
    """Names of a stroke's colour, the most exact first; none where it has no ink."""
    space = stroke.get("colorspace") or ""
    c = [float(v) for v in (stroke.get("color") or "").split()]
    spot = re.fullmatch(r"(?:Separation|DeviceN)\((.*)\)", space, re.DOTALL)
    if spot:
        inks = spot[1].split(",")[1:]
        seen = [ink for ink, share in zip(inks, c) if share > 0 and ink != "None"]
        return ("+".join(seen),) if seen else ()
    if len(c) == 1:
        return (hexadecimal(c[0], c[0], c[0]),)
    if len(c) == 3:
        return (hexadecimal(*c),)
    if len(c) == 4:
        return ("cmyk " + " ".join(str(round(100 * v)) for v in c),
                hexadecimal(*[(1 - v) * (1 - c[3]) for v in c[:3]]))
    return ("colours of " + space,)


class PdfReader:
    def __init__(self, sheet, height):
        self.sheet, self.height, self.layers = sheet, height, []

    def walk(self, parent):
        for element in parent:
            if element.tag == "layer":
                self.layers.append((element.get("name") or "").encode())
            elif element.tag == "end_layer":
                self.layers.pop()
            elif element.tag == "stroke_path":
                self.stroke(element)
            elif element.tag == "clip_path":
                self.sheet.remarks.add("clips")
            self.walk(element)

    def stroke(self, stroke):
        names = colours(stroke)
        if not names:
            return
        dashed = any(name.startswith("dash") for name in stroke.attrib)
        key = (tuple(self.layers), names, "dashed" if dashed else "continuous", True)
        a, b, c, d, e, f = (float(v) for v in stroke.get("transform").split())

        def point(step, n=""):
            x, y = float(step.get("x" + n)), float(step.get("y" + n))
            return MM * complex(a * x + c * y + e, self.height - (b * x + d * y + f))

        at = start = 0j
        for step in stroke:
            if step.tag == "moveto":
                at = start = point(step)
            elif step.tag == "lineto":
                self.sheet.add(key, Line(at, point(step)))
                at = point(step)
            elif step.tag == "curveto":
                self.sheet.add(key, Bezier(at, point(step, "1"), point(step, "2"), point(step, "3")))
                at = point(step, "3")
            elif step.tag == "closepath":
                self.sheet.add(key, Line(at, start))
                at = start
            else:
                raise ValueError(f"step {step.tag} of a path is not known")


def read_pdf(path, sheet, _told_mm, number):
    done = subprocess.run([MUTOOL, "draw", "-q", "-F", "trace", path, str(number)], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
    if done.returncode != 0:
        raise ValueError(f"mutool ended with {done.returncode}: {done.stderr.decode('ascii', 'replace')[-200:]}")
    page = xml.fromstring(done.stdout).find("page")
    box = [float(v) for v in page.get("mediabox").split()]
    PdfReader(sheet, box[3]).walk(page)
    return "MuPDF", MM
