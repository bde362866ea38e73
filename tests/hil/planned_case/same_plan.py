#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""same_plan.py BIN SOURCE [--all]: plans shipped scenarios by `kerfplan program --scenario` and by `kerfbench plan --program`, and
holds what both write against each other, byte by byte. Where one refuses, the other must as well, with the same exit code. Without
--all: one scenario of each kind."""
import pathlib
import subprocess
import sys
import tempfile

bin_dir, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
SCENARIOS = source / "fixtures/scenarios"
# Two mirrors on a belt, kerf's radius, the controller's feed, a gantry, power by depth, planner's faults, other processors, no plan.
FEW = ["label-on-belt", "label-edges", "label-fed", "strip-crosscut", "short-lines", "faults/belt-ignored", "stm32/label-on-belt",
       "native/label-on-belt", "line-ok/plate"]
wrong = []


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, cwd=source, check=False)
    return done.returncode, done.stdout + done.stderr


def check(condition, words):
    if not condition:
        wrong.append(words)
        print(words, flush=True)


def same(scenario, folder):
    """Compares the two for a scenario; returns whether it was planned."""
    ours, theirs = folder / "kerfplan.txt", folder / "kerfbench.txt"
    for path in (ours, theirs):
        path.unlink(missing_ok=True)
    by_plan, said_by_plan = run(bin_dir / "kerfplan", "program", "--scenario", scenario, "-o", ours)
    by_bench, said_by_bench = run(bin_dir / "kerfbench", "plan", scenario, "--program", theirs)
    name = scenario.relative_to(SCENARIOS)
    check(by_plan == by_bench and by_plan in (0, 65), f"{name}: exit codes {by_plan} and {by_bench}\n{said_by_plan}{said_by_bench}")
    check((by_plan == 0) == ours.exists() and (by_bench == 0) == theirs.exists(), f"{name}: a program is written where it fits, and only there")
    if by_plan == 0 and by_bench == 0:
        check(ours.stat().st_size > 0 and ours.read_bytes() == theirs.read_bytes(), f"{name}: the programs differ")
    return by_plan == 0


def options_go_before_files(folder):
    """An option that is given is used, and one that has no effect beside the files is refused."""
    label = SCENARIOS / "label-on-belt.yaml"
    plain, slow, other = (folder / name for name in ("plain.txt", "slow.txt", "other.txt"))
    check(run(bin_dir / "kerfplan", "program", "--scenario", label, "-o", plain)[0] == 0, "the label is planned")
    check(run(bin_dir / "kerfplan", "program", "--scenario", label, "--mark-speed", "250", "-o", slow)[0] == 0, "the label is planned at 250 mm/s")
    check(plain.read_bytes() != slow.read_bytes(), "--mark-speed goes before the scenario")
    code, said = run(bin_dir / "kerfplan", "check", "--scenario", label, "--unit", "in")
    check(code == 64 and "--unit has no effect" in said, f"--unit beside --scenario: {code} {said}")
    code, said = run(bin_dir / "kerfplan", "check")
    check(code == 64 and "DIELINE or --scenario is required" in said, f"neither drawing nor scenario: {code} {said}")
    code, said = run(bin_dir / "kerfplan", "check", "--scenario", folder / "none.yaml")
    check(code == 65 and "none.yaml" in said, f"a scenario that is not there: {code} {said}")
    # A machine alone: its own values are the defaults, and the job's are those of the program.
    drawing = source / "fixtures/dielines/label-60x40.dxf"
    gantry = source / "fixtures/machines/strip-gantry.yaml"
    check(run(bin_dir / "kerfplan", "program", drawing, "--machine", gantry, "--web-start", "100", "-o", other)[0] == 0, "the label is planned for the gantry")
    code, said = run(bin_dir / "kerfplan", "check", drawing, "--machine", gantry, "--throw", "400")
    check(code == 64 and "--throw has no effect" in said, f"--throw on a gantry: {code} {said}")
    # The scenario's drawing by its path is the scenario's drawing; G-code goes in place of it.
    code, _ = run(bin_dir / "kerfplan", "program", drawing, "--scenario", label, "-o", other)
    check(code == 0 and other.read_bytes() == plain.read_bytes(), "the same drawing, named")
    gcode = folder / "label.nc"
    check(run(bin_dir / "kerfplan", "gcode", "--scenario", label, "-o", gcode)[0] == 0, "G-code is written")
    code, said = run(bin_dir / "kerfplan", "program", gcode, "--scenario", label, "-o", other)
    check(code == 0 and other.read_bytes() == plain.read_bytes(), f"its own G-code makes the same program: {code} {said}")


with tempfile.TemporaryDirectory() as made:
    place = pathlib.Path(made)
    every = sorted(SCENARIOS.rglob("*.yaml"))
    chosen = every if "--all" in sys.argv else [SCENARIOS / f"{name}.yaml" for name in FEW]
    planned = sum(same(scenario, place) for scenario in chosen)
    check(planned > len(chosen) // 2, f"only {planned} of {len(chosen)} were planned")
    options_go_before_files(place)
    print(f"{len(chosen)} scenarios, {planned} planned with the same bytes by both")
sys.exit(1 if wrong else 0)
