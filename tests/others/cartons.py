# SPDX-License-Identifier: Apache-2.0
"""Cartons that other people's programs draw, from file to verdict: the second table of docs/explanation/drawings-of-others.md.

Each of tests/others/cartons.toml is drawn by its program, cut as fixtures/scenarios/native/carton-on-belt.yaml is, on each
machine of that file, and judged. Then the job is spoiled and judged against the same drawing, on the first machine: larger by
0.2 %, one line less, creases cut as cuts. A good job that does not PASS, and a spoiled one that does not FAIL, is named.
"""
import collections
import concurrent.futures
import json
import math
import os
import re
import subprocess
import tempfile
import tomllib

import unpacking

LIST = "tests/others/cartons.toml"
SCALE = 1.002
HALF_POWER = 0.5
LONGEST_S = 1800
# Programs that know no curves write polylines. An ellipse in pieces of these lengths, mm, on the first machine.
PIECES_MM = (0.15, 0.3, 0.5, 0.8, 1.2, 2.0)

Carton = collections.namedtuple("Carton", "what folder read creases")
Verdict = collections.namedtuple("Verdict", "word failing values")


def read_list(root):
    with open(os.path.join(root, LIST), "rb") as opened:
        return tomllib.load(opened)


def drawn(root, top, told, into):
    """Has a carton drawn by its program. Returns it with the folder in which the drawing lies."""
    folder = os.path.join(into, told["name"])
    source = os.path.join(folder, "program")
    unpacking.all_of(top, told["folder"], told["commit"], source)
    maker = os.path.join(root, "tests", "others", "makers", told["maker"])
    with open(maker, "rb") as opened, open(os.path.join(source, told["maker"]), "wb") as copy:
        copy.write(opened.read())
    drawing = os.path.join(folder, told["drawing"])
    with open(drawing, "wb") as file:
        made = subprocess.run(["bash", "-o", "pipefail", "-c", told["make"].replace("MAKER", told["maker"])],
                              cwd=source, stdout=file, stderr=subprocess.PIPE, check=False)
    if made.returncode != 0 or os.path.getsize(drawing) == 0:
        raise unpacking.Missing(f"{told['what']}: {told['make']}: {made.stderr.decode().strip()[-300:]}")
    return Carton(told["what"], folder, told["read"], "crease" in told["read"] or "CREASE" in open(drawing).read())


def scenario(root, carton, name, extra):
    """Writes a scenario into the carton's folder. Returns its path. `extra` is YAML after the drawing."""
    fixtures = os.path.join(root, "fixtures")
    extra = extra.replace("MACHINES", os.path.join(fixtures, "machines"))
    path = os.path.join(carton.folder, name + ".yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"extends: {fixtures}/scenarios/native/carton-on-belt.yaml\nname: {name}\n{carton.read}\n{extra}\n")
    return path


def judged(program, path):
    """Runs a scenario. Returns what its verdict says, and its folder of results."""
    results = os.path.splitext(path)[0]
    done = subprocess.run([program, "run", path, "--twin", "fast", "--no-pictures", "--results-dir", results],
                          capture_output=True, text=True, timeout=LONGEST_S, check=False)
    latest = os.path.join(results, os.path.basename(results), "latest")
    if not os.path.exists(os.path.join(latest, "verdict.json")):
        return Verdict("no verdict", [(done.stderr or done.stdout).strip()[-300:]], {}), latest
    with open(os.path.join(latest, "verdict.json"), encoding="utf-8") as file:
        told = json.load(file)
    checks = {check["name"]: check for check in told["checks"]}
    failing = sorted(name for name, check in checks.items() if check["verdict"] != "PASS")
    return Verdict(told["verdict"], failing, checks), latest


def enlarged(gcode):
    return re.sub(r"([XYIJ])(-?\d+(?:\.\d+)?)", lambda m: f"{m[1]}{float(m[2]) * SCALE:.6f}", gcode)


def one_less(gcode):
    """Without one of its cuts: the beam jumps there."""
    cuts = re.findall(r"^G01 .* Z1\b.*$", gcode, flags=re.MULTILINE)
    if not cuts:
        return gcode
    cut = cuts[len(cuts) // 2]
    return gcode.replace(cut, cut.replace("G01", "G00", 1).replace(" Z1", " Z0"), 1)


def deep_creases(gcode):
    return re.sub(rf"\bZ{HALF_POWER}\b", "Z1", gcode)


def spoiled(root, program, carton, results):
    """Verdicts on the job of a good run that was spoiled."""
    with open(os.path.join(results, "job.gcode"), encoding="utf-8") as file:
        gcode = file.read()
    for word, spoil in (("0.2 % larger", enlarged), ("one line less", one_less), ("creases cut through", deep_creases)):
        if spoil is deep_creases and not carton.creases:
            continue
        changed = spoil(gcode)
        if changed == gcode:
            raise unpacking.Missing(f"{carton.what}: {word}: nothing in the job to change")
        name = "spoiled-" + word.split()[0].replace(".", "")
        job = os.path.join(carton.folder, name + ".gcode")
        with open(job, "w", encoding="utf-8") as file:
            file.write(changed)
        yield word, judged(program, scenario(root, carton, name, f"planner: {{gcode: {job}}}"))[0]


def shown(verdict):
    if verdict.word != "PASS":
        return f"{verdict.word}: {', '.join(verdict.failing)}"
    most = {name: verdict.values[name].get("value") for name in ("path", "joints") if name in verdict.values}
    return "PASS, " + ", ".join(f"{name} {1000 * value:.1f} µm" for name, value in most.items() if value is not None)


def row_of(root, program, carton, machines):
    """The row of a carton, and what of it is not as it should be."""
    cells, wrong = [carton.what, f"`{carton.read.strip().replace(chr(10), '; ')}`"], []
    for i, machine in enumerate(machines):
        verdict, results = judged(program, scenario(root, carton, f"good-{i}", machine["scenario"]))
        cells.append(shown(verdict))
        if verdict.word != "PASS":
            wrong.append(f"{carton.what}, {machine['name']}: {shown(verdict)}")
        if i == 0:
            first = results
    bad = list(spoiled(root, program, carton, first))
    wrong += [f"{carton.what}, {word}: {shown(verdict)}" for word, verdict in bad if verdict.word != "FAIL"]
    cells.append("; ".join(f"{word}: {shown(verdict)}" for word, verdict in bad))
    return "| " + " | ".join(cells) + " |", wrong


def ellipse(piece_mm):
    """An SVG of an ellipse of 60 x 40 mm as one polyline of pieces of equal angle, of that length on average."""
    a, b = 30.0, 20.0
    sides = round(math.pi * (3 * (a + b) - math.sqrt((3 * a + b) * (a + 3 * b))) / piece_mm)
    turn = [2 * math.pi * i / sides for i in range(sides)]
    places = " L".join(f"{35 + a * math.cos(t):.6f} {25 + b * math.sin(t):.6f}" for t in turn)
    return ('<svg xmlns="http://www.w3.org/2000/svg" width="70mm" height="50mm" viewBox="0 0 70 50">'
            f'<path fill="none" stroke="#ff0000" d="M{places} Z"/></svg>\n'), sides


def row_of_pieces(root, program, into, piece_mm, machine):
    folder = os.path.join(into, f"pieces-{piece_mm}")
    os.mkdir(folder)
    text, sides = ellipse(piece_mm)
    with open(os.path.join(folder, "ellipse.svg"), "w", encoding="utf-8") as file:
        file.write(text)
    carton = Carton("", folder, "dieline: {file: ellipse.svg, shift: [-105, -25]}", False)
    verdict, _ = judged(program, scenario(root, carton, "good", machine["scenario"]))
    told = shown(verdict) + ("" if "gate_lag" in verdict.values else "; `gate_lag` is not judged")
    return f"| {piece_mm} mm | {sides} | {told} |", [] if verdict.word == "PASS" else [f"pieces of {piece_mm} mm: {told}"]


def table_of_pieces(root, program, jobs):
    """Lines of the table of an ellipse in pieces, and what is not as it should be."""
    machine = read_list(root)["machine"][0]
    lines, wrong = ["| pieces of | number | verdict |", "|---|---|---|"], []
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for row, faults in pool.map(lambda piece: row_of_pieces(root, program, folder, piece, machine), PIECES_MM):
            lines.append(row)
            wrong += faults
    return lines, wrong


def table(root, top, program, jobs):
    """Lines of the table, and what is not as it should be."""
    told = read_list(root)
    machines = told["machine"]
    lines = ["| carton | how it is read | " + " | ".join(machine["name"] for machine in machines) + " | spoiled jobs |",
             "|" + "---|" * (len(machines) + 3)]
    wrong = []
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        cartons = [drawn(root, top, one, folder) for one in told["carton"]]
        for row, faults in pool.map(lambda carton: row_of(root, program, carton, machines), cartons):
            lines.append(row)
            wrong += faults
    return lines, wrong
