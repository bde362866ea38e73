# SPDX-License-Identifier: Apache-2.0
"""The commands that read what users and others bring, and a sound file for each."""
import io
import os
import pathlib
import shutil
import struct
import subprocess
import zipfile
import zlib

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIXTURES = ROOT / "fixtures"
SCENARIO = f"""extends: {FIXTURES}/scenarios/native/label-on-belt.yaml
name: sound
twin: fast
print: {{units: 1}}
"""
CHILD_SCENARIO = f"""extends: {FIXTURES}/scenarios/pins/plate.yaml
name: child
twin: fast
firmware: {{source: child, image: IMAGE, child: CHILD, dialog: none}}
time_limit_s: 0.02
"""
MACHINE = f"extends: {FIXTURES}/machines/two-mirror.yaml\nname: two-mirror\n"
CF2 = ("$BOF\nV2\nORDER\n%1:TOOL\nEND\nMAIN,DESIGN\nUM\nLL,-500,-500\nUR,500,500\nSCALE,1,1\n"
       "L,2,1,0,0,0,10,0,0,0\nL,2,1,0,10,0,10,10,0,0\nL,2,1,0,10,10,0,0,0,0\nEND\n$EOF\n")
GRID = "".join(f"{x} {y} 0.0{x + 90} 0.01\n" for y in (-80, 0, 80) for x in (-80, 0, 80))
TARGET = "calibrate target --columns 12 --rows 9 --square-mm 8 --out target.svg"
# A scan of it, as wide as the glass: less white around the squares, and less contrast than black and white have.
SCANNED = (('width="116mm" height="92mm" viewBox="-10 -10 116 92"', 'width="85mm" height="61mm" viewBox="5.5 5.5 85 61"'),
           ("#fff", "#e6e6e6"), ("#000", "#1e1e1e"))


class Reader:
    """A command that is given a file. `command`: words, in which FILE stands for the file, SOUND for the folder of sound files
    and OUT for a folder that is made for each case."""

    def __init__(self, name, command, sound, *, text, suffix=None, where=None, codes=(), any_size=False):
        self.name, self.command, self.sound, self.is_text, self.codes = name, command, sound, text, codes
        self.suffix = pathlib.Path(sound).suffix if suffix is None else suffix
        self.any_size = any_size  # It goes through a file in pieces, or takes its sum, whatever its size (decision 088).
        self.where = where  # Path within a copy of this folder where the file lies, if a folder is what is read.


READERS = [
    Reader("dxf", "kerfbench lint FILE", "label.dxf", text=True),
    Reader("svg", "kerfbench lint FILE", "label.svg", text=True),
    Reader("cf2", "kerfbench lint FILE", "label.cf2", text=True),
    Reader("pdf", "kerfbench lint FILE", "label.pdf", text=False),
    Reader("xyz", "kerfplan compensate FILE --kerf-radius 0.1", "corner.xyz", text=True),
    Reader("gcode", "kerfplan check FILE", "job.gcode", text=True),
    Reader("scenario", "kerfbench lint FILE", "sound.yaml", text=True),
    Reader("machine", "kerfbench lint FILE", "machine.yaml", text=True),
    Reader("fold", "kerfbench fold FILE -q --results-dir OUT", "fold.yaml", text=True),
    Reader("suite", "kerfbench suite FILE --list --results-dir OUT", "suite.yaml", text=True),
    Reader("campaign", "kerfbench campaign FILE --list -o OUT/campaign", "campaign.yaml", text=True, codes=(75,)),
    Reader("material", "kerfplan power --material FILE --laser SOUND/laser.yaml --depth 0.2 --spot-diameter 0.2", "material.yaml",
           text=True),
    Reader("edited", "kerfbench edit FILE --set belt.speed_mm_s=30", "sound.yaml", text=True),
    Reader("vcd", "kerfbench motion FILE --scenario SOUND/sound.yaml -q --out OUT/motion", "pins.vcd", text=True,
           any_size=True),
    Reader("sr", "kerfbench motion FILE --scenario SOUND/sound.yaml -q --out OUT/motion", "pins.sr", text=False),
    Reader("trace", "kerfbench trace info FILE", "run.mcap", text=False),
    Reader("trace part", "kerfbench trace recover FILE --out OUT/whole.mcap", "run.mcap", text=False),
    Reader("diagnosis", "kerfbench diagnose FILE", "diagnosis-evidence.json", text=True),
    Reader("results list", "kerfbench verify COPY -q", "kerfbench-results.txt", text=True, suffix="", where="results",
           any_size=True),
    Reader("verdict", "kerfbench compare SOUND/results COPY -q --out OUT/compare", "verdict.json", text=True, suffix="",
           where="results", any_size=True),
    Reader("table-csv", "kerfbench calibrate table FILE", "table.csv", text=True),
    Reader("table-header", "kerfbench calibrate table FILE", "table.h", text=True),
    Reader("table-cor1", "kerfbench calibrate table FILE", "table1.cor", text=False),
    Reader("table-cor2", "kerfbench calibrate table FILE", "table2.cor", text=False),
    Reader("table-grid", "kerfbench calibrate table FILE --format grid-text", "table.txt", text=True),
    Reader("nine points", "kerfbench calibrate table FILE --format nine-points", "nine.fixup", text=True),
    Reader("correction", "kerfplan check SOUND/label.dxf --correction FILE", "table.csv", text=True),
    Reader("target", "kerfbench calibrate scanner --scan SOUND/page.png --dpi 300 --target FILE --date 2026-11-29 --out OUT/scanner.yaml",
           "target.yaml", text=True),
    Reader("picture", "kerfbench calibrate scanner --scan FILE --dpi 300 --target SOUND/target.yaml --date 2026-11-29 --out OUT/s.yaml",
           "page.png", text=False),
    Reader("camera", "kerfbench lint COPY/machine.yaml", "spot.camera.yaml", text=True, suffix="", where="machine"),
    Reader("image hex", "kerfbench doctor --child BIN/kerfbench-avr --image FILE --for 0.001", "controller-avr.hex", text=True),
    Reader("image elf", "kerfbench doctor --child BIN/kerfbench-cortex-m --image FILE --for 0.001 --mcu stm32f103",
           "controller-stm32.elf", text=False),
    Reader("release", "kerfbench lint SOUND/sound.yaml --image FILE", "controller-avr.hex", text=True),
    Reader("child", "kerfbench doctor --child FILE --image SOUND/child.txt --for 0.001", "script_child.py", text=False),
]


def png(width, height, gray=255, rows=None, bits=8):
    """A grey picture; `rows` in place of its content."""
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    if rows is None:
        rows = zlib.compress((b"\0" + bytes([gray]) * (width * bits // 8)) * height)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)) +
            chunk(b"IDAT", rows) + chunk(b"IEND", b""))


def pdf(content, pages=1):
    """A PDF of one page whose lines are `content`."""
    objects = [b"<</Type/Catalog/Pages 2 0 R>>", b"<</Type/Pages/Kids[3 0 R]/Count %d>>" % pages,
               b"<</Type/Page/Parent 2 0 R/MediaBox[0 0 300 300]/Resources<<>>/Contents 4 0 R>>",
               b"<</Length %d>>stream\n" % len(content) + content + b"\nendstream"]
    out, places = b"%PDF-1.4\n", []
    for number, text in enumerate(objects, 1):
        places.append(len(out))
        out += b"%d 0 obj\n" % number + text + b"\nendobj\n"
    table = b"xref\n0 5\n0000000000 65535 f \n" + b"".join(b"%010d 00000 n \n" % place for place in places)
    return out + table + b"trailer<</Size 5/Root 1 0 R>>\nstartxref\n%d\n%%%%EOF\n" % len(out)


def session(metadata, parts):
    """A session file of sigrok."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("version", "2")
        archive.writestr("metadata", metadata)
        for name, content in parts.items():
            archive.writestr(name, content)
    return file.getvalue()


WIRES = ("galvo_x_pul", "galvo_x_dir", "galvo_y_pul", "galvo_y_dir", "laser_gate", "laser_pwm", "encoder_a", "encoder_b")


def metadata(rate="1 MHz", wires=WIRES, more=""):
    names = "".join(f"probe{i}={name}\n" for i, name in enumerate(wires, 1))
    return (f"[global]\nsigrok version=0.5.2\n\n[device 1]\ncapturefile=logic-1\ntotal probes={len(wires)}\nsamplerate={rate}\n"
            f"total analog=0\n{names}unitsize=1\n{more}")


class Bench:
    """The programs of a build, and a folder with a sound file for each reader."""

    def __init__(self, build, folder, runner):
        self.runner = runner
        self.bin, self.firmware = pathlib.Path(build).resolve() / "bin", pathlib.Path(build).resolve() / "firmware"
        self.sound = pathlib.Path(folder) / "sound"
        self.sound.mkdir()

    def tell(self, words, codes=(0,)):
        ours = self.bin / words[0]
        command = [ours if ours.exists() else words[0], *words[1:]]
        done = subprocess.run(command, cwd=self.sound, capture_output=True, text=True, check=False)
        if done.returncode not in codes:
            raise RuntimeError(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")

    def prepare(self):
        at = self.sound
        (at / "sound.yaml").write_text(SCENARIO)
        self.tell(["kerfbench", "run", "sound.yaml", "--no-pictures", "-q", "--trace", "--trace-frames", "0", "--keep-evidence",
                   "--output", "results", "-j", "1"])
        for name in ("pins.vcd", "run.mcap", "job.gcode", "diagnosis-evidence.json", "kerfbench-results.txt", "verdict.json"):
            shutil.copy(at / "results" / name, at / name)
        for source, name in (("dielines/label-60x40.dxf", "label.dxf"), ("dielines/label-60x40.svg", "label.svg"),
                             ("contours/box-corner.xyz", "corner.xyz"), ("power/mild-steel.yaml", "material.yaml"),
                             ("power/co2-tube-80w.yaml", "laser.yaml"), ("children/script_child.py", "script_child.py")):
            shutil.copy(FIXTURES / source, at / name)
        for name in ("controller-avr.hex", "controller-stm32.elf"):
            shutil.copy(self.firmware / name, at / name)
        (at / "label.cf2").write_text(CF2)
        (at / "label.pdf").write_bytes(pdf(b"0 0 m 100 0 l 100 100 l h S"))
        (at / "machine.yaml").write_text(MACHINE)
        (at / "child.txt").write_text("16000 0 1\n32000 0 0\n")
        (at / "fold.yaml").write_text(f"extends: {FIXTURES}/fold/shallow-edge.yaml\nname: sound\n")
        (at / "suite.yaml").write_text(f"version: 1\nname: sound\nruns:\n  - scenario: {at}/sound.yaml\n")
        (at / "campaign.yaml").write_text(f"version: 1\nname: sound\nbase: {at}/sound.yaml\nfactors:\n"
                                          "  - {name: speed, key: belt.speed_mm_s, values: [30, 45]}\n")
        (at / "pins.sr").write_bytes(session(metadata(), {"logic-1-1": bytes(range(256)) * 64}))
        (at / "table.txt").write_text("# nodes: 3 x 3\n" + GRID)
        (at / "nine.fixup").write_text("".join(f"{x} {y} 0.0{i} 0.02\n" for i, (x, y) in enumerate(
            (x, y) for y in (-20, 0, 20) for x in (-20, 0, 20))))
        for form, name in (("csv", "table.csv"), ("c-header", "table.h"), ("cor1", "table1.cor"), ("cor2", "table2.cor")):
            self.tell(["kerfbench", "calibrate", "table", "table.txt", "--format", "grid-text", "--to", form, "--out", name, "-q"])
        self.tell(["kerfbench", *TARGET.split(), "-q"])
        target = (at / "target.svg").read_text()
        for printed, seen in SCANNED:
            target = target.replace(printed, seen)
        (at / "scanned.svg").write_text(target)
        self.tell(["rsvg-convert", "-d", "300", "-p", "300", "scanned.svg", "-o", "page.png"])
        (at / "machine").mkdir()
        (at / "machine/machine.yaml").write_text(MACHINE + "cameras: {spot: {calibration: spot.camera.yaml}}\n")
        for folder in (at, at / "machine"):
            shutil.copy(FIXTURES / "machines/two-mirror.spot.camera.yaml", folder / "spot.camera.yaml")
        (at / "script_child.py").chmod(0o755)

    def command(self, reader, file, out, extra=()):
        """Words of a reader's command; a folder that it reads is copied first, with the file in it."""
        words = reader.command.split() + list(extra)
        copy = pathlib.Path(out) / (reader.where or "none")
        if reader.where:
            if not copy.exists():
                shutil.copytree(self.sound / reader.where, copy)
            place = copy / reader.sound
            place.unlink()
            if os.path.lexists(file):
                os.rename(file, place)
        put = {"FILE": str(file), "SOUND": str(self.sound), "OUT": str(out), "COPY": str(copy), "BIN": str(self.bin)}
        words[0] = str(self.bin / words[0])
        for i, word in enumerate(words[1:], 1):
            for name, value in put.items():
                if word == name or word.startswith(name + "/"):
                    words[i] = value + word[len(name):]
        return words

    def costs(self, reader, place):
        """What the reader's command takes with the sound file."""
        out = pathlib.Path(place)
        file = out / ("hostile" + reader.suffix)
        shutil.copy(self.sound / reader.sound, file)
        return self.runner.run(self.command(reader, file, out), str(out))
