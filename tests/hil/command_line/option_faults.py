#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""option_faults.py SOURCE BIN: the command lines of option_faults.toml, what they end with and what they say; and one recording that is
judged from standard input as from its file."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

source, bin_dir = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
WORDS = {"label": source / "fixtures/dielines/label-60x40.dxf", "scenario": source / "fixtures/scenarios/label-on-belt.yaml",
         "plan": source / "fixtures/suites/label-release.yaml"}
# What no user has typed or read: C++'s names, and the words for what the programs did not foresee.
INTERNAL = re.compile(r"std::|basic_string|filesystem error|terminate called|CLI::|itself broke|/kerfbench-input\.")
wrong = []


def run(line, folder, stdin=None):
    # Nothing of results and files stays in the sources: they are written into the current folder, or nowhere.
    with open(source / stdin if stdin else os.devnull, "rb") as given:
        done = subprocess.run(["sh", "-c", line], cwd=folder, env=dict(os.environ, PATH=f"{bin_dir}:{os.environ['PATH']}"), stdin=given,
                              capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def check(condition, words):
    if not condition:
        wrong.append(words)
        print(words, flush=True)


def try_case(case, folder):
    line = case["line"].format(**WORDS)
    code, said = run(line, source / case["folder"] if "folder" in case else folder, case.get("stdin"))
    check(code == case["exit"], f"{line}: exit code {code}, not {case['exit']}: {said[-400:]}")
    for words in case["says"]:
        check(words in said, f"{line}: does not say {words!r} but {said[-400:]!r}")
    check(not INTERNAL.search(said), f"{line}: {said[-400:]}")


def replay_from_standard_input(folder):
    scenario = source / "fixtures/scenarios/native/label-on-belt.yaml"
    one = folder / "one.yaml"
    one.write_text(f"extends: {scenario}\nname: one\nprint: {{units: 1}}\n", encoding="utf-8")
    code, said = run(f"kerfbench run -q {one} --twin fast --no-pictures -j 1", folder)
    check(code == 0, f"a run: {code} {said}")
    digests = []
    for recording, out in (("results/one/latest/pins.vcd", "by-file"), ("-", "by-pipe")):
        given = "cat results/one/latest/pins.vcd | " if recording == "-" else ""
        code, said = run(f"{given}kerfbench replay -q {recording} --scenario {one} --twin fast --no-pictures -j 1 --output {out}", folder)
        check(code == 0, f"replay {recording}: {code} {said}")
        verdict = json.loads((folder / out / "verdict.json").read_text(encoding="utf-8")) if code == 0 else {}
        digests.append(verdict.get("digest"))
    check(digests[0] is not None and digests[0] == digests[1], f"replayed from a file and from standard input: {digests}")


with tempfile.TemporaryDirectory() as made:
    place = pathlib.Path(made)
    cases = tomllib.loads((pathlib.Path(__file__).parent / "option_faults.toml").read_text(encoding="utf-8"))["case"]
    for each in cases:
        try_case(each, place)
    replay_from_standard_input(place)
    print(f"{len(cases)} command lines")
sys.exit(1 if wrong else 0)
