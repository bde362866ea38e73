#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A second reader of drawings. It prints one object of JSON: lengths and boxes of what a drawing shows, by layer,
colour and linetype, read by other people's libraries and with rules of its own. Processes are not its business.

    second_reader.py --format dxf|svg|pdf [--unit-mm MM] [--page N] [--scale S] [--turn DEGREES] [--shift-x X]
                     [--shift-y Y] FILE

Names are percent-encoded bytes, since a drawing's need not be UTF-8. What it lacks is told as {"missing": PACKAGE},
what it cannot read as {"refused": WORDS}."""
import argparse
import importlib
import json
import math
import os
import sys
from urllib.parse import quote

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from witness_curves import Sheet  # noqa: E402

# Format -> module, function, library and the Debian package that has it.
READERS = {"dxf": ("witness_dxf", "read_dxf", "ezdxf", "python3-ezdxf"),
           "svg": ("witness_svg", "read_svg", "svgelements", "python3-svgelements"),
           "pdf": ("witness_pdf", "read_pdf", "", "mupdf-tools")}


class Missing(Exception):
    """A package that is not installed."""


def identity(key):
    names, colours, linetype, plotted = key
    return {"names": [quote(n) for n in names], "colours": [quote(c) for c in colours], "linetype": quote(linetype),
            "plotted": plotted}


def read(path, form, told_mm=None, page=1, **placed):
    """What the drawing shows, as it is printed. `told_mm`: millimetres of a unit, whatever the file says."""
    module, function, library, package = READERS[form]
    try:
        if library:
            importlib.import_module(library)
        reader = importlib.import_module(module)
    except ImportError as error:
        raise Missing(package) from error
    sheet = Sheet(**placed)
    name, mm_per_unit = getattr(reader, function)(str(path), sheet, told_mm, page)
    groups = [dict(identity(key), count=len(lengths), length_mm=math.fsum(lengths), box_mm=sheet.boxes[key])
              for key, lengths in sheet.lengths.items()]
    unread = [dict(identity(key), what=quote(what), count=count) for (key, what), count in sheet.unread.items()]
    return {"reader": name, "mm_per_unit": mm_per_unit, "groups": groups, "unread": unread,
            "remarks": sorted(sheet.remarks)}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("file")
    parser.add_argument("--format", choices=READERS, required=True)
    parser.add_argument("--unit-mm", type=float)
    parser.add_argument("--page", type=int, default=1)
    parser.add_argument("--scale", type=float, default=1.0)
    parser.add_argument("--turn", type=float, default=0.0)
    parser.add_argument("--shift-x", type=float, default=0.0)
    parser.add_argument("--shift-y", type=float, default=0.0)
    told = parser.parse_args()
    try:
        result = read(told.file, told.format, told.unit_mm, told.page, scale=told.scale,
                      turn_deg=told.turn, shift_mm=(told.shift_x, told.shift_y))
    except Missing as missing:
        result = {"missing": str(missing)}
    except MemoryError:
        raise
    except Exception as error:  # Whatever a library throws at a drawing is an answer.
        words = f"{type(error).__name__}: {error}".encode("ascii", "replace").decode()
        result = {"refused": words[:300]}
    json.dump(result, sys.stdout, allow_nan=False)


if __name__ == "__main__":
    main()
