# SPDX-License-Identifier: Apache-2.0
"""Reads all drawings (.dxf, .svg) below folders with the reader under test and with a second one, all lines as one
process, and compares length and box to 1 um. Writes a row for each folder, then what was refused and what differs.
Usage: drawings_of_others.py MEASURE FOLDER…  No test: the drawings are other people's, and not in this repository."""
import collections
import json
import pathlib
import re
import signal
import subprocess
import sys

import second_reader

LIMIT_MM = 1e-3
LONGEST_S = 60
CURVES = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE")
SOLIDS = ("3DSOLID", "3DFACE", "MESH", "BODY", "REGION", "SURFACE", "POLYFACE")


class Anything(dict):
    """One process, whatever the layer."""
    def __missing__(self, key):
        return "cut"


class TooLong(Exception):
    pass


def first(measure, path):
    unit = ["--unit", "mm"] if path.suffix.lower() == ".dxf" else []
    done = subprocess.run([measure, *unit, "--layer", "*/other=cut", str(path)], capture_output=True, text=True,
                          errors="replace", timeout=LONGEST_S)
    if done.returncode != 0:
        raise ValueError(done.stderr.strip().splitlines()[0].replace(str(path), "FILE"))
    return json.loads(done.stdout)


def shown(entities, layers, layer_of_insert="0"):
    """Entities that are shown, by ezdxf. A frozen layer hides inserts on it, one that is off does not."""
    for entity in entities:
        if entity.dxf.get("layer", "0") == "0":
            entity.dxf.layer = layer_of_insert
        layer = layers.get(entity.dxf.layer.lower())
        kind = entity.dxftype()
        if entity.dxf.get("invisible", 0) or (layer and layer.is_frozen()):
            continue
        if kind == "INSERT":
            for copy in entity.multi_insert() if entity.mcount > 1 else [entity]:
                yield from shown(copy.virtual_entities(), layers, entity.dxf.layer)
            continue
        if entity.dxf.layer.lower() == "defpoints" or (layer and (layer.is_off() or layer.dxf.get("plot", 1) == 0)):
            continue
        if kind in ("LWPOLYLINE", "POLYLINE"):
            yield from entity.virtual_entities()
        elif kind in CURVES:
            yield entity
        elif kind in SOLIDS:
            raise ValueError(f"a {kind}")


class OneSpace:
    """A drawing as the second reader asks for it, of what is shown."""
    def __init__(self, entities):
        self.entities = entities

    def modelspace(self):
        return self.entities


def second_dxf(path):
    import ezdxf
    from ezdxf import recover
    try:
        drawing = ezdxf.readfile(path)
    except ezdxf.DXFError:
        drawing = recover.readfile(path)[0]
    layers = {layer.dxf.name.lower(): layer for layer in drawing.layers}
    kept = []
    for entity in shown(drawing.modelspace(), layers):
        is_dot = entity.dxftype() in ("ARC", "CIRCLE") and entity.dxf.radius == 0
        if is_dot or (entity.dxftype() == "LINE" and (entity.dxf.end - entity.dxf.start).magnitude < 1e-9):
            continue
        if entity.dxftype() == "ELLIPSE" and abs(entity.dxf.end_param - entity.dxf.start_param - 6.283185307) < 1e-7:
            entity.dxf.start_param, entity.dxf.end_param = 0.0, 0.0  # A whole one, whose end was rounded.
        kept.append(entity)
    ezdxf_readfile = ezdxf.readfile
    ezdxf.readfile = lambda _: OneSpace(kept)
    try:
        return second_reader.read_dxf(path, 1.0)
    finally:
        ezdxf.readfile = ezdxf_readfile


def second_svg(path):
    text = path.read_text(errors="replace")
    old = re.search(r"inkscape:version=\"0\.(\d+)", text)
    per_inch = 96
    if re.search(r"<!-- Generator: Adobe Illustrator", text):
        per_inch = 72
    elif old and int(old[1]) < 92:
        per_inch = 90
    return second_reader.read_svg(path, 25.4 / per_inch)


def outcome(measure, path):
    """A word for the table, and what there is to say."""
    try:
        ours = first(measure, path)
    except ValueError as fault:
        return "refused", str(fault)
    try:
        theirs = second_dxf(path) if path.suffix.lower() == ".dxf" else second_svg(path)
    except Exception as fault:  # Whatever the other library makes of a stranger's file.
        return "second reader failed", repr(fault)[:120]
    a, b = sum(ours["lengths_mm"].values()), sum(theirs["lengths_mm"].values())
    if not ours["lengths_mm"] or not theirs["lengths_mm"]:
        return ("empty" if a == b else "differ"), f"{a:.4f} and {b:.4f} mm"
    box = max(abs(p - q) for p, q in zip(ours["box_mm"], theirs["box_mm"], strict=True))
    if abs(a - b) <= LIMIT_MM and box <= LIMIT_MM:
        return "agree", ""
    return "differ", f"{a:.4f} and {b:.4f} mm, boxes by {box:.4f} mm"


def raise_too_long(*_):
    raise TooLong(f"more than {LONGEST_S} s")


def main(measure, folders):
    second_reader.PROCESS_OF_LAYER = second_reader.PROCESS_OF_STROKE = Anything()
    signal.signal(signal.SIGALRM, raise_too_long)
    words = ("agree", "empty", "refused", "second reader failed", "differ")
    said = collections.defaultdict(list)
    print("| folder | drawings | " + " | ".join(words) + " |\n|" + "---|" * (len(words) + 2))
    for folder in map(pathlib.Path, folders):
        for kind in (".dxf", ".svg"):
            counts = collections.Counter()
            for path in sorted(p for p in folder.rglob("*") if p.suffix.lower() == kind and p.is_file()):
                signal.alarm(2 * LONGEST_S)
                try:
                    word, text = outcome(measure, path)
                except TooLong as fault:
                    word, text = "differ", str(fault)
                signal.alarm(0)
                counts[word] += 1
                if text and word != "empty":
                    said[word].append(f"{path.relative_to(folder.parent)}: {text}")
            if counts:
                print(f"| {folder.name} {kind} | {sum(counts.values())} | "
                      + " | ".join(str(counts[word]) for word in words) + " |", flush=True)
    for word, lines in said.items():
        print(f"\n{word}:\n" + "\n".join(lines))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
