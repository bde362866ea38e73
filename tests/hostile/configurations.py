# SPDX-License-Identifier: Apache-2.0
"""Scenarios, machines, plans and other YAML and JSON that is made to harm."""
import os

from cases import FOREIGN, MIB, SECRET, Case, writes
from readers import CHILD_SCENARIO, FIXTURES, MACHINE, SCENARIO


def bomb(key):
    """Anchors of anchors: ten to the power of nine."""
    text = f"{key}a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
    for i in range(1, 10):
        text += f"{key}a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n"
    return text


def beside(files, text):
    """A file that names others, which lie beside it."""
    def make(path, draw):
        for name, content in files.items():
            (path.parent / name).write_text(content)
        writes(text)(path, draw)
    return make


def extends_cycle(path, _draw):
    (path.parent / "other.yaml").write_text(f"extends: {path.name}\n")
    path.write_text("extends: other.yaml\n")


def extends_chain(path, _draw):
    for i in range(2000):
        (path.parent / f"link{i}.yaml").write_text(f"extends: link{i + 1}.yaml\n")
    path.write_text("extends: link0.yaml\n")


def extends_fifo(path, _draw):
    os.mkfifo(path.parent / "pipe.yaml")
    path.write_text("extends: pipe.yaml\n")


def names_fifo(key):
    def make(path, _draw):
        os.mkfifo(path.parent / "pipe.dxf")
        path.write_text(SCENARIO + f"{key}: pipe.dxf\n")
    return make


def names_foreign(key_and_value, name="foreign.txt"):
    def make(path, _draw):
        (path.parent / name).write_text(FOREIGN)
        path.write_text(SCENARIO + key_and_value)
    return make


def yaml_cases(reader, sound):
    """What any reader of YAML is given."""
    return [
        Case(reader, "anchors of anchors", writes(sound + bomb("x")), group="amplification", quick=reader == "scenario"),
        Case(reader, "lists 10^5 deep", writes(sound + "deep: " + "[" * 100_000), group="deep nesting", quick=reader == "scenario"),
        Case(reader, "mappings 10^5 deep", writes(sound + "deep: " + "{a: " * 100_000), group="deep nesting"),
        Case(reader, "blocks 2000 deep", writes(sound + "deep:\n" + "".join(" " * i + "a:\n" for i in range(1, 2000))), group="deep nesting"),
        Case(reader, "a second document", writes(sound + "---\nname: other\n"), group="second document"),
        Case(reader, "a key twice", writes(sound + "name: other\n"), group="second document"),
        Case(reader, "unknown keys, 20 000", writes(sound + "".join(f"key{i}: 1\n" for i in range(20_000))), group="entities"),
        Case(reader, "key of 1 MiB", writes(sound + "k" * MIB + ": 1\n"), group="long lines"),
        Case(reader, "key with escape sequences", writes(sound + '"\\e]0;x\\a\\e[31m": 1\n"\\x9b2J": 2\n'), group="terminal", quick=True),
        Case(reader, "key with a workflow command", writes(sound + '"\\n::set-output name=a::b": 1\n"##[add-mask]x": 1\n'), group="terminal"),
        Case(reader, "name with escape sequences", writes(sound.replace("name: ", 'name: "\\e[31m" #')), group="terminal"),
        Case(reader, "name of 300 letters", writes(sound.replace("name: ", "name: " + "n" * 300 + " #")), group="names"),
        Case(reader, "name ../up", writes(sound.replace("name: ", "name: ../../up #")), group="paths"),
        Case(reader, "extends itself", writes("extends: hostile.yaml\n"), group="cycles", quick=reader == "scenario"),
        Case(reader, "extends cycle", extends_cycle, group="cycles"),
        Case(reader, "extends 2000 files", extends_chain, group="cycles", named=["link"]),
        Case(reader, "extends /etc/passwd", writes("extends: /etc/passwd\n"), group="foreign", secret="root:x:", named=["passwd"],
             quick=reader == "scenario"),
        Case(reader, "extends a foreign file", beside({"foreign.txt": FOREIGN}, "extends: foreign.txt\n"), group="foreign", secret=SECRET,
             named=["foreign.txt"]),
        Case(reader, "extends a file of keys and secrets", beside({"foreign.yaml": f"password: {SECRET}\ntoken: {SECRET}\n"},
             "extends: foreign.yaml\n"), group="foreign", secret=SECRET, named=["foreign.yaml"]),
        Case(reader, "extends a FIFO", extends_fifo, group="no file", named=["pipe.yaml"]),
        Case(reader, "extends a device", writes("extends: /dev/zero\n"), group="no file", named=["zero"]),
        Case(reader, "tags of other programs", writes(sound + 'x: !!python/object/apply:os.system ["touch pwned"]\n'), group="foreign"),
    ]


def scenario_cases():
    numbers = {"not a number": ".nan", "infinite": ".inf", "1e308": "1e308", "minus 1e308": "-1e308", "400 digits": "9" * 400,
               "hexadecimal": "0xffffffffffffffff", "octal": "0777", "text": "sixty"}
    made = [Case("scenario", f"speed {name}", writes(SCENARIO + f"belt: {{speed_mm_s: {value}}}\n"), group="numbers",
                 quick=name == "not a number") for name, value in numbers.items()]
    made += [
        Case("scenario", "-1 units", writes(SCENARIO.replace("units: 1", "units: -1")), group="counts"),
        Case("scenario", "10^18 units", writes(SCENARIO.replace("units: 1", "units: 1000000000000000000")), group="counts"),
        Case("scenario", "seed 2^64", writes(SCENARIO + "seed: 18446744073709551616\n"), group="numbers"),
        Case("scenario", "time limit 1e300", writes(SCENARIO + "time_limit_s: 1e300\n"), group="numbers"),
        Case("scenario", "10^5 marks", writes(SCENARIO.replace("units: 1", "units: 1, marks: [" + "{x_mm: 1, y_mm: 1}, " * 100_000 + "]")),
             group="entities"),
        Case("scenario", "dieline is /etc/passwd", writes(SCENARIO + "dieline: /etc/passwd\n"), group="foreign", secret="root:x:",
             named=["passwd"]),
        Case("scenario", "dieline is a foreign .dxf", names_foreign("dieline: foreign.dxf\n", "foreign.dxf"), group="foreign", secret=SECRET,
             named=["foreign.dxf"]),
        Case("scenario", "dieline is a foreign .cf2", names_foreign("dieline: foreign.cf2\n", "foreign.cf2"), group="foreign", secret=SECRET,
             named=["foreign.cf2"]),
        Case("scenario", "dieline is a FIFO", names_fifo("dieline"), group="no file", named=["pipe.dxf"]),
        Case("scenario", "machine is a foreign file", names_foreign("machine: foreign.txt\n"), group="foreign", secret=SECRET,
             named=["foreign.txt"]),
        Case("scenario", "machine is a FIFO", names_fifo("machine"), group="no file", named=["pipe.dxf"]),
        Case("scenario", "machine is a folder", writes(SCENARIO + "machine: /etc\n"), group="no file", named=["etc"]),
        Case("scenario", "G-code is a foreign file", names_foreign("planner: {gcode: foreign.txt}\n"), group="foreign", secret=SECRET,
             named=["foreign.txt"]),
        Case("scenario", "G-code is /dev/zero", writes(SCENARIO + "planner: {gcode: /dev/zero}\n"), group="no file", named=["zero"]),
        Case("scenario", "correction is a foreign file", beside({"foreign.csv": FOREIGN, "m.yaml": MACHINE +
             "controller: {correction: foreign.csv}\n"}, SCENARIO + "machine: m.yaml\n"), group="foreign", secret=SECRET,
             named=["foreign.csv"]),
        Case("scenario", "material is a foreign file", names_foreign(
             "planner: {power: {material: foreign.txt, laser: foreign.txt, depth_mm: 0.2, spot_diameter_mm: 0.2}}\n"), group="foreign",
             secret=SECRET, named=["foreign.txt"]),
        Case("scenario", "dieline with control characters", writes(SCENARIO + 'dieline: "a\\e[31m\\n::x::.dxf"\n'), group="names"),
        Case("scenario", "layers with control characters", writes(SCENARIO + 'layers: {"\\e[31m": cut, "a": "\\e[2J"}\n'), group="terminal"),
        Case("scenario", "title with control characters", writes(SCENARIO + 'title: "\\e]0;x\\a\\n::set-output name=a::b"\n'), group="terminal"),
    ]
    machine = [
        Case("machine", "mirror step not a number", writes(MACHINE + "galvo_x: {step_urad: .nan}\n"), group="numbers"),
        Case("machine", "mirror step 1e-300", writes(MACHINE + "galvo_x: {step_urad: 1e-300}\ncontroller: {mirror_step_urad: 1e-300}\n"),
             group="numbers"),
        Case("machine", "camera of 10^9 pixels", writes(MACHINE + "cameras: {spot: {width_px: 1000000000, height_px: 1000000000}}\n"),
             group="counts"),
        Case("machine", "calibration ../../etc/passwd", writes(MACHINE + "cameras: {spot: {calibration: ../../../../../../etc/passwd}}\n"),
             group="paths", secret="root:x:", named=["passwd"]),
        Case("machine", "driver with escape sequences", writes(MACHINE + 'galvo_x: {driver: "\\e[31m"}\n'), group="terminal"),
    ]
    return made + machine


def plan_cases():
    suite = "version: 1\nname: hostile\nruns:\n"
    campaign = f"version: 1\nname: hostile\nbase: {FIXTURES}/scenarios/native/label-on-belt.yaml\nfactors:\n"
    factor = "  - {name: a, key: belt.speed_mm_s, values: [30]}\n"
    return [
        Case("suite", "pattern of /", writes(suite + "  - scenario: /*/*/*/*/*.yaml\n"), group="amplification",
             honest=(20.0, 256 * MIB)),
        Case("suite", "10^5 seeds", writes(suite + f"  - scenario: {FIXTURES}/scenarios/native/button.yaml\n    seeds: [" +
             ", ".join(map(str, range(100_000))) + "]\n"), group="entities", honest=(5.0, 256 * MIB)),
        Case("suite", "pattern of 10^4 stars", writes(suite + f"  - scenario: {FIXTURES}/scenarios/{'*' * 10_000}x.yaml\n"),
             group="amplification"),
        Case("suite", "scenario is a foreign file", beside({"foreign.txt": FOREIGN}, suite + "  - scenario: foreign.txt\n"), group="foreign",
             secret=SECRET, named=["foreign.txt"]),
        Case("suite", "run named ../up", writes(suite + f"  - scenario: {FIXTURES}/scenarios/native/button.yaml\n    name: ../../up\n"),
             group="paths"),
        Case("campaign", "10^15 draws", writes(campaign + factor + "draws: 1000000000000000\n"), group="counts", quick=True),
        Case("campaign", "grid of 10^12", writes(campaign + "".join(
            f"  - {{name: f{i}, key: belt.k{i}, values: [{', '.join(map(str, range(1000)))}]}}\n" for i in range(4))), group="amplification"),
        Case("campaign", "normal of sigma not a number", writes(campaign + "  - {name: a, key: belt.speed_mm_s, "
             "normal: {mean: .nan, sigma: .inf}}\ndraws: 5\n"), group="numbers"),
        Case("campaign", "value with line feeds", writes(campaign + '  - {name: a, key: title, values: ["a\\nb: c", "\\e[31m"]}\n'),
             group="terminal"),
        Case("campaign", "key ../up", writes(campaign + '  - {name: ../up, key: ../../belt, values: [1]}\n'), group="paths"),
        Case("diagnosis", "nested 10^5 deep", writes("[" * 100_000), group="deep nesting", quick=True),
        Case("diagnosis", "objects 10^5 deep", writes('{"a":' * 100_000), group="deep nesting"),
        Case("diagnosis", "numbers beyond all", writes('{"version": 1e999, "cuts": -1}'), group="numbers"),
        Case("diagnosis", "other types", writes('{"version": [], "cuts": "x"}'), group="numbers"),
        Case("verdict", "nested 10^5 deep", writes('{"checks":' * 100_000), group="deep nesting"),
        Case("verdict", "other types", writes('{"schema_version": 1, "checks": 5, "verdict": {}, "scenario": []}'), group="numbers"),
        Case("verdict", "a number for each text", writes('{"schema_version": 1, "checks": [{"name": 1, "value": "x"}], "verdict": 1}'),
             group="numbers"),
        Case("results list", "paths upwards", writes("kerfbench results 1\n" + "0" * 64 + "  ../../../../etc/passwd\n"), group="paths"),
        Case("results list", "names with escape sequences", writes(f"kerfbench results 1\n{'0' * 64}  \x1b[31m\x1b]0;x\x07.txt\n"),
             group="terminal", quick=True),
        Case("camera", "not a number", writes("version: 1\nfocal_px: .nan\n"), group="numbers"),
        Case("target", "squares 10^9 x 10^9", writes("version: 1\ncolumns: 1000000000\nrows: 1000000000\nsquare_mm: 8\nmarker_mm: 6\n"),
             group="counts"),
        Case("material", "points not ascending", writes("version: 1\nkind: material\nname: x\nunits: {power_per_area: J/mm2, depth: mm}\n"
             "points: [{power_per_area: .nan, depth: .inf}, {power_per_area: -1, depth: 0}]\n"), group="numbers"),
    ]


def child_scenario(child, image):
    return CHILD_SCENARIO.replace("CHILD", str(child)).replace("IMAGE", str(image))
