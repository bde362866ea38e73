# SPDX-License-Identifier: Apache-2.0
"""Where foreign text enters, and where it comes out. A stage is given a string, puts it wherever it can, runs the commands, and
returns their outputs, each with the parser of its other side."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import parsers
from strings import told

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIXTURES = ROOT / "fixtures"
CHILD = r"""#!/usr/bin/python3
import struct, sys
def read(n):
    data = sys.stdin.buffer.read(n)
    if len(data) < n: sys.exit(0)
    return data
def ask():
    size, kind = struct.unpack("<IB", read(5))
    return kind, read(size)
def put(kind, payload):
    sys.stdout.buffer.write(struct.pack("<IB", len(payload), kind) + payload); sys.stdout.buffer.flush()
def text(words): return struct.pack("<H", len(words)) + words
NAME, MESSAGE, ERROR, UART = (bytes.fromhex(word) for word in (%s))
ask()
if ERROR: put(66, text(ERROR)); sys.exit(1)
put(65, struct.pack("<IQQI", 1, 1, 16000000, 0) + text(NAME))
while True:
    kind, payload = ask()
    if kind == 5: sys.exit(0)
    if kind == 4:
        put(67, struct.pack("<BQI", 2 if MESSAGE else 0, struct.unpack("<Q", payload)[0], 0) + struct.pack("<I", len(UART)) + UART + text(MESSAGE))
        UART = b""
        if MESSAGE: sys.exit(0)
"""


class Place:
    """A folder for one string."""

    def __init__(self, bench, folder, text):
        self.bench, self.at, self.text = bench, pathlib.Path(folder), text
        self.outputs, self.marks = [], []

    def put(self, place):
        """The string as it enters at a place."""
        self.marks.append(place)
        return told(self.text, place)

    def name(self, place, suffix):
        """A file's name with the string in it; slashes and what the command line refuses are left out."""
        try:
            usable = self.put(place).decode("utf-8", "surrogateescape")
        except UnicodeDecodeError:
            usable = place
        usable = re.sub(r"[/\x00-\x1f\x7f-\x9f]", "", usable)[:180]
        return ("x" + usable if usable.startswith("-") else usable) + suffix

    def quoted(self, place):
        """For YAML, which is text: bytes that are none are replaced, control characters escaped."""
        return json.dumps(self.put(place).decode("utf-8", "replace"))

    def plain(self, place):
        """For YAML that must be read: without the control characters that it refuses."""
        text = re.sub(r"[\x00-\x1f\x7f-\x9f]", " ", self.put(place).decode("utf-8", "replace"))
        return json.dumps(text)

    def tell(self, program, *words, codes=(0, 1, 2, 3, 4, 64, 65), taken=parsers.terminal, title=None):
        command = [self.bench / program, *words]
        done = subprocess.run(command, cwd=self.at, capture_output=True, check=False,
                              env={"PATH": os.environ["PATH"], "HOME": str(self.at), "LANG": "C.UTF-8"})
        title = title or f"{program} {words[0]}"
        self.outputs.append((f"{title}: terminal", taken, done.stdout))
        self.outputs.append((f"{title}: terminal", parsers.terminal, done.stderr))
        if done.returncode not in codes or done.returncode == 2:
            self.fail(title, done)
        return done

    def fail(self, title, done):
        """A command that has not done what the stage goes on with."""
        said = (done.stdout + done.stderr)[-300:]
        self.outputs.append((title, lambda _: [f"exit code {done.returncode}: {said!r}"], b""))

    def take(self, title, parser, path):
        for file in sorted(self.at.glob(path)):
            self.outputs.append((title, parser, file.read_bytes()))

    def child(self, name=b"child", message=b"", error=b"", uart=b""):
        path = self.at / "child.py"
        path.write_text(CHILD % ", ".join(repr(part.hex()) for part in (name, message, error, uart)))
        path.chmod(0o755)
        (self.at / "image").write_text("")


def dxf(layer):
    """A square of 20 mm on a layer, with a crease through it on another."""
    corners = [(0, 0), (20, 0), (20, 20), (0, 20), (0, 0)]
    out = b"0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n"
    for (x, y), (u, v) in zip(corners, corners[1:]):
        out += b"0\nLINE\n8\n" + layer + f"\n10\n{x}\n20\n{y}\n11\n{u}\n21\n{v}\n".encode()
    return out + b"0\nENDSEC\n0\nEOF\n"


def one_line(text):
    return re.sub(rb"[\r\n]", b" ", text)


def scenario(place, more, firmware, base="pins/plate.yaml"):
    return (f"extends: {FIXTURES}/scenarios/{base}\nname: travel\ntwin: fast\ntitle: {place.plain('kbtitle')}\n"
            f"firmware: {firmware}\n{more}")


def results(place, folder):
    """What lies in a results folder, and what other commands make of it."""
    place.take("report.html", parsers.page, f"{folder}/travel*/2*/report.html")
    place.take("verdict.json", parsers.values, f"{folder}/travel*/2*/verdict.json")
    place.take("junit.xml", parsers.markup, f"{folder}/travel*/2*/junit.xml")
    place.take("job.gcode", parsers.gcode, f"{folder}/travel*/2*/job.gcode")
    for name in ("travel", "travel-replay"):
        if (place.at / folder / name).is_dir():
            place.tell("kerfbench", "history", name, "--results-dir", folder)
            place.tell("kerfbench", "compare", f"{folder}/{name}", f"{folder}/{name}", "--out", "compared")
            place.tell("kerfbench", "verify", f"{folder}/{name}")
    place.take("history.html", parsers.page, f"{folder}/travel*/history.html")
    place.take("compare.html", parsers.page, "compared/compare.html")
    place.take("compare.json", parsers.values, "compared/compare.json")
    summarised(place, folder)


def summarised(place, folder):
    done = subprocess.run([sys.executable, "-B", str(ROOT / "packaging/ci/summary.py"), folder], cwd=place.at, check=False,
                          capture_output=True)
    if done.returncode != 0:
        place.fail("summary.py", done)
    place.take("summary.md", parsers.markdown, f"{folder}/summary.md")
    place.take("junit.xml of all", parsers.markup, f"{folder}/junit.xml")


def repeats(place, command):
    """The command that repeats a run, pasted into a shell."""
    for file in sorted(place.at.glob("results/travel*/2*/verdict.json")):
        told_command = json.loads(file.read_bytes())["repeat_command"]
        words = [os.fsencode(word) for word in command]
        place.outputs.append(("repeat command in a shell", lambda content, words=words: parsers.shell(content.decode(), words, place.at),
                              told_command.encode()))


def run_stage(place):
    """A whole run: names of files, layer, title, machine, serial number."""
    drawing, machine = place.name("kbdrawing", ".dxf"), place.name("kbmachine", ".yaml")
    layer = one_line(place.put("kblayer"))
    (place.at / drawing).write_bytes(dxf(layer))
    image = place.name("kbimage", "")
    shutil.copy(place.bench.parent / "firmware/controller-native", place.at / image)
    (place.at / machine).write_text(f"extends: {FIXTURES}/machines/two-mirror-gated.yaml\nname: {place.plain('kbmachinename')}\n"
                                    f"cameras: {{spot: {{calibration: {FIXTURES}/machines/two-mirror.spot.camera.yaml}}, "
                                    f"kerf: {{calibration: {FIXTURES}/machines/two-mirror.kerf.camera.yaml}}}}\n", errors="surrogateescape")
    file = place.name("kbscenario", ".yaml")

    def yaml(name):
        return json.dumps(name, ensure_ascii=False)
    (place.at / file).write_text(scenario(place, f"dieline: {yaml(drawing)}\nmachine: {yaml(machine)}\nlayers: {{'*': cut}}\n",
                                          f"{{source: native, image: {yaml(image)}, mcu: native}}"), errors="surrogateescape")
    serial = re.sub(r"[\x00-\x1f\x7f]", "", place.put("kbserial").decode("utf-8", "surrogateescape"))[:60]
    command = ["run", file, "--no-pictures", "--serial-number", serial, "-j", "1"]
    serial_bytes = os.fsencode(serial)[:60]
    command[4] = os.fsdecode(serial_bytes)
    place.tell("kerfbench", *command, "--events", "events.jsonl", title="kerfbench run", codes=(0, 1, 3, 4))
    place.take("events", lambda content: parsers.values(content, lines=True), "events.jsonl")
    results(place, "results")
    repeats(place, command)
    place.tell("kerfbench", "lint", file)
    place.tell("kerfbench", "lint", file, "--json", title="kerfbench lint --json", taken=lambda content: parsers.values(content, lines=True))
    place.tell("kerfbench", "plan", file)
    place.tell("kerfbench", "plan", file, "--json", title="kerfbench plan --json", taken=parsers.values)


def child_stage(place):
    """A release that crashes: its name and its last words; a suite and a campaign of it."""
    place.child(name=place.put("kbchildname")[:60], message=place.put("kbmessage"))
    (place.at / "travel.yaml").write_text(scenario(place, "time_limit_s: 0.05\n", "{source: child, image: image, child: child.py, dialog: none}"))
    place.tell("kerfbench", "run", "travel.yaml", "--no-pictures", codes=(3,))
    results(place, "results")
    (place.at / "suite.yaml").write_text(f"version: 1\nname: suite\ntitle: {place.plain('kbsuite')}\nruns:\n"
                                         f"  - {{scenario: travel.yaml, tags: [{place.plain('kbtag')}]}}\n")
    place.tell("kerfbench", "suite", "suite.yaml", "--no-pictures", "--results-dir", "suites", "-j", "1")
    place.take("suite's index.html", parsers.page, "suites/suite/2*/index.html")
    place.take("suite's summary.json", parsers.values, "suites/suite/2*/summary.json")
    place.take("suite's junit.xml", parsers.markup, "suites/suite/2*/junit.xml")
    summarised(place, "suites")
    (place.at / "campaign.yaml").write_text(
        f"version: 1\nname: campaign\ntitle: {place.plain('kbcampaign')}\nbase: travel.yaml\nfactors:\n"
        f"  - {{name: {place.plain('kbfactor')}, key: title, values: [{place.plain('kbvalue')}]}}\n")
    place.tell("kerfbench", "campaign", "campaign.yaml", "-o", "campaign", "-j", "1", codes=(0, 2, 65, 75))
    place.take("campaign.html", parsers.page, "campaign/campaign.html")
    place.take("campaign's JSON", parsers.values, "campaign/analysis.json")
    place.take("campaign's records", lambda content: parsers.values(content, lines=True), "campaign/results.jsonl")


def words_stage(place):
    """What a controller says over its UART, and an emulator that cannot run an image."""
    place.child(uart=b"error: " + place.put("kbuart")[:200] + b"\n")
    text = scenario(place, "time_limit_s: 1\n", "{source: child, image: image, child: child.py}", "line-ok/plate.yaml")
    (place.at / "travel.yaml").write_text(text.replace("child: child.py", f"child: child.py, gcode: {FIXTURES}/scenarios/line-ok/plate.gcode"))
    place.tell("kerfbench", "run", "travel.yaml", "--no-pictures", codes=(3,))
    results(place, "results")
    place.child(error=place.put("kberror"))
    place.tell("kerfbench", "run", "travel.yaml", "--no-pictures", "--results-dir", "refused", title="kerfbench run, refused")
    place.tell("kerfbench", "doctor", "--child", "./child.py", "--image", "image")
    place.tell("kerfbench", "doctor", "--child", "./child.py", "--image", "image", "--json", title="kerfbench doctor --json", taken=parsers.values)


def drawing_stage(place):
    """Drawings, G-code, tables and recordings that are only looked at."""
    layer = one_line(place.put("kblayer"))
    name = place.name("kbfile", "")
    (place.at / f"{name}.dxf").write_bytes(dxf(layer))
    (place.at / f"{name}.cf2").write_bytes(b"$BOF\nV2\nORDER\nEND\nMAIN,M\nUM\nLL,0,0\nUR,9,9\nSCALE,1,1\nC," + layer +
                                           b",0,0,0,1,1\nL,2," + layer + b",0,0,0,5,5,0,0\nEND\n$EOF\n")
    escaped = layer.decode("utf-8", "replace").replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    (place.at / f"{name}.svg").write_text('<svg xmlns="http://www.w3.org/2000/svg" width="50mm" height="50mm" viewBox="0 0 50 50">'
                                          f'<g id="{escaped}" class="{escaped}"><path stroke="{escaped}" d="{escaped}"/>'
                                          f'<use href="#{escaped}"/></g></svg>')
    (place.at / f"{name}.nc").write_bytes(b"G00 X0 Y0\n(" + layer + b")\n" + layer + b"\nG01 X10 Y0 Z1\n")
    (place.at / f"{name}.csv").write_bytes(b"x_mm,y_mm,dx_mm,dy_mm\n" + layer + b",0,0,0\n# nodes: " + layer + b"\n")
    for suffix in ("dxf", "cf2", "svg"):
        place.tell("kerfbench", "lint", f"{name}.{suffix}", "--layer", "*=cut", title=f"kerfbench lint .{suffix}")
        place.tell("kerfbench", "show", f"{name}.{suffix}", "--layer", "*=cut", "--out", f"shown-{suffix}.svg", title=f"kerfbench show .{suffix}")
        place.take("picture of a drawing (SVG)", parsers.markup, f"shown-{suffix}.svg")
    for command, more in (("check", ()), ("gcode", ("-o", "out.gcode")), ("preview", ("-o", "preview.html")),
                          ("program", ("--target", "mcs51", "-o", "program.c")), ("order", ())):
        place.tell("kerfplan", command, f"{name}.dxf", "--layer", "*=cut", *more)
    place.tell("kerfplan", "check", f"{name}.nc", title="kerfplan check .nc")
    place.tell("kerfplan", "preview", f"{name}.nc", "-o", "preview-nc.html", title="kerfplan preview .nc")
    place.take("preview", parsers.page, "preview*.html")
    place.take("G-code", parsers.gcode, "out.gcode")
    place.take("program in C", parsers.source, "program.c")
    place.tell("kerfbench", "new", f"{name}.dxf", "--machine", str(FIXTURES / "machines/two-mirror.yaml"), "-o", "new.yaml")
    place.tell("kerfbench", "calibrate", "table", f"{name}.csv")
    (place.at / "keys.yaml").write_text(f"extends: {FIXTURES}/scenarios/native/label-on-belt.yaml\nname: travel\n"
                                        f"{place.quoted('kbkey')}: 1\ntitle: {place.quoted('kbtext')}\ntwin: {place.quoted('kbchoice')}\n")
    place.tell("kerfbench", "lint", "keys.yaml")
    place.tell("kerfbench", "run", place.put("kbargument").replace(b"\0", b""), title="kerfbench run, no such file")
    place.tell("kerfbench", place.put("kbcommand").replace(b"\0", b""), title="kerfbench, no such command")
    wires = b"".join(b"$var wire 1 %c %s $end\n" % (33 + i, one_line(layer).replace(b" ", b"_") if i == 0 else b"w%d" % i) for i in range(3))
    problem = "".join(f"%{byte:02X}" for byte in place.put("kbproblem")).encode()
    (place.at / "pins.vcd").write_bytes(b"$timescale 1 us $end\n" + wires + b"$enddefinitions $end\n$comment kerfbench problem " + problem +
                                        b" $end\n#0\n0!\n#10\n1!\n")
    place.tell("kerfbench", "motion", "pins.vcd", "--scenario", str(FIXTURES / "scenarios/native/label-on-belt.yaml"))


def recording_stage(place):
    """A problem that a recording tells, in a replay's results."""
    names = ("galvo_x_pul", "galvo_x_dir", "galvo_y_pul", "galvo_y_dir", "laser_gate")
    wires = b"".join(b"$var wire 1 %c %s $end\n" % (33 + i, name.encode()) for i, name in enumerate(names))
    problem = "".join(f"%{byte:02X}" for byte in place.put("kbproblem")).encode()
    file = place.name("kbrecording", ".vcd")
    (place.at / file).write_bytes(b"$timescale 1 us $end\n" + wires + b"$enddefinitions $end\n$comment kerfbench tick 1/1000000 $end\n"
                                  b"$comment kerfbench problem " + problem + b" $end\n#0\n" +
                                  b"".join(b"0%c\n" % (33 + i) for i in range(len(names))) + b"#50000\n1!\n#50010\n0!\n#60000\n")
    (place.at / "travel.yaml").write_text(scenario(place, "", "{source: native, image: controller-native, mcu: native}"))
    command = ["replay", file, "--scenario", "travel.yaml", "--no-pictures"]
    place.tell("kerfbench", *command, title="kerfbench replay", codes=(0, 1, 3, 4))
    results(place, "results")
    repeats(place, command)
    place.tell("kerfbench", "motion", file, "--scenario", "travel.yaml", "--out", "motion")
    place.take("motion.csv", parsers.table, "motion/motion.csv")


STAGES = {"run": run_stage, "child": child_stage, "words": words_stage, "drawing": drawing_stage, "recording": recording_stage}
