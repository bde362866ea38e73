#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs libFuzzer on every reader of what comes from outside, two at a time, and writes tests/fuzz/RESULTS.md.

Each target starts from the repository's own files and from sound inputs that the bench's writers make; a corpus in the build folder
keeps what was found by earlier runs. A target that breaks leaves its file in the build folder: mend the reader and put the file into
tests/fuzz/findings/TARGET, where a test hands it to the reader again. Exit code: 0 nothing broke, 1 something did, 2 the targets
cannot be built or run, 64 usage, 77 with --no-page where there is no libFuzzer.
"""
import argparse
import concurrent.futures
import glob
import os
import re
import shutil
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HERE = os.path.dirname(os.path.abspath(__file__))
LARGEST_SEED = 64 << 10

# Seeds from the repository, by target; the writers' are in sound_inputs.cpp.
SEEDS = {
    "drawing_dxf": ["fixtures/dielines/**/*.dxf"],
    "drawing_svg": ["fixtures/dielines/**/*.svg"],
    "scenario": ["fixtures/scenarios/**/*.yaml"],
    "machine": ["fixtures/machines/*.yaml"],
    "gcode": ["fixtures/scenarios/**/*.gcode"],
    "camera_calibration": ["fixtures/machines/*.camera.yaml"],
    "calibration_target": ["fixtures/machines/*target*.yaml"],
}
# Words by which a format is made, for targets that share one: dictionaries/NAME.dict.
DICTIONARIES = {
    "drawing_dxf": "dxf", "drawing_svg": "svg", "drawing_pdf": "pdf", "drawing_cf2": "cf2", "scenario": "scenario", "machine": "machine",
    "recording_vcd": "vcd", "gcode": "gcode", "correction_table": "table", "controller_table": "table", "image_hex": "hex",
    "camera_calibration": "calibration", "calibration_target": "calibration", "scanner_calibration": "calibration", "mark_job": "calibration",
    "tile_list": "tiles", "frame_recording": "frames", "http_head": "http",
}


# What decides the figures of the page.
SOURCES = ("firmware_under_test/planner/gcode firmware_under_test/planner/head/correction.cpp hil/base hil/calibrate/files "
           "hil/calibrate/tables hil/camera hil/dieline hil/machine_file hil/scenario hil/source hil/trace tests/fuzz")


def targets():
    """Names of the targets, from the list that the tests hold against the readers."""
    with open(os.path.join(HERE, "targets.cpp"), encoding="utf-8") as file:
        return re.findall(r'Target\{"(\w+)"', file.read())


def has_libfuzzer():
    found = subprocess.run(["clang++", "-print-resource-dir"], capture_output=True, text=True, check=False)
    return found.returncode == 0 and bool(glob.glob(os.path.join(found.stdout.strip(), "lib/linux/libclang_rt.fuzzer-*.a")))


def build(folder, names):
    """Builds the targets by the preset `fuzz`; the words of what failed, or nothing."""
    if not os.path.exists(os.path.join(folder, "build.ninja")):
        made = subprocess.run(["cmake", "--preset", "fuzz"], cwd=ROOT, capture_output=True, text=True, check=False)
        if made.returncode != 0:
            return made.stdout[-2000:] + made.stderr[-2000:]
    wanted = ["fuzz_seeds"] + ["fuzz_" + name for name in names]
    made = subprocess.run(["ninja", "-C", folder, *wanted], capture_output=True, text=True, check=False)
    return "" if made.returncode == 0 else made.stdout[-4000:]


def seed_corpus(folder, names):
    """A corpus for each target: what was there, what the writers make, and files of the repository."""
    corpora = os.path.join(folder, "corpus")
    subprocess.run([os.path.join(folder, "fuzz", "fuzz_seeds"), corpora], check=True)
    for name in names:
        corpus = os.path.join(corpora, name)
        os.makedirs(corpus, exist_ok=True)
        for pattern in SEEDS.get(name, []) + [f"tests/fuzz/findings/{name}/*"]:
            for path in sorted(glob.glob(os.path.join(ROOT, pattern), recursive=True)):
                if os.path.getsize(path) <= LARGEST_SEED:
                    shutil.copyfile(path, os.path.join(corpus, os.path.relpath(path, ROOT).replace("/", "_")))


def run(folder, name, seconds, seed):
    """One target. What libFuzzer says of it at its end, as a row."""
    artifacts = os.path.join(folder, "findings", name)
    os.makedirs(artifacts, exist_ok=True)
    before = set(os.listdir(artifacts))
    command = [os.path.join(folder, "fuzz", "fuzz_" + name), os.path.join(folder, "corpus", name), f"-max_total_time={seconds}", f"-seed={seed}",
               f"-max_len={LARGEST_SEED}", "-timeout=10", "-rss_limit_mb=1024", "-malloc_limit_mb=512", "-print_final_stats=1",
               f"-artifact_prefix={artifacts}/"]
    dictionary = os.path.join(HERE, "dictionaries", DICTIONARIES.get(name, "none") + ".dict")
    if os.path.exists(dictionary):
        command.append("-dict=" + dictionary)
    began = time.monotonic()
    done = subprocess.run(command, capture_output=True, check=False, env={**os.environ, "UBSAN_OPTIONS": "print_stacktrace=1"})
    said = done.stderr.decode("utf-8", "replace")
    with open(os.path.join(folder, "findings", name + ".log"), "w", encoding="utf-8") as log:
        log.write(said)
    number = lambda pattern: int((re.findall(pattern, said) or ["0"])[-1])
    runs = number(r"stat::number_of_executed_units:\s+(\d+)")
    spent = max(time.monotonic() - began, 1e-3)
    found = sorted(set(os.listdir(artifacts)) - before)
    # libFuzzer ends at its first finding.
    return {"target": name, "runs": runs, "per_s": runs / spent, "edges": number(r"cov: (\d+)"), "peak_mb": number(r"stat::peak_rss_mb:\s+(\d+)"),
            "found": found, "broke": done.returncode != 0, "seconds": spent}


def page_of(rows, line, seconds, seed):
    text = ["<!-- SPDX-License-Identifier: Apache-2.0 -->", "# Readers under libFuzzer", "", line, "",
            f"`./bench fuzz` runs libFuzzer on every reader of what comes from outside, each for {seconds:.0f} s from the repository's own files, seed "
            f"{seed}, built by clang++ with AddressSanitizer and UndefinedBehaviorSanitizer. A reader must take what it is given or refuse it in words;",
            "a fault of memory, an overflow, any other exception, 10 s for one input of at most 64 KiB, 512 MiB in one piece or 1 GiB in all is a finding.",
            "Coverage is the number of edges that were reached. Whatever broke a reader is a file in [findings](findings/README.md), and a test.", "",
            "| target | runs | runs/s | edges | peak, MiB | findings |", "|---|---|---|---|---|---|"]
    for row in rows:
        text.append(f"| {row['target']} | {row['runs']} | {row['per_s']:.0f} | {row['edges']} | {row['peak_mb']} | {len(row['found'])} |")
    text += ["", f"{len(rows)} targets, {sum(row['runs'] for row in rows)} runs, {sum(len(row['found']) for row in rows)} findings in this run.", ""]
    return "\n".join(text)


def main():
    parser = argparse.ArgumentParser(prog="bench fuzz", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=30.0, help="for all targets together, on two cores (default: 30)")
    parser.add_argument("--seconds", type=float, help="the same in seconds")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="these targets alone; writes no page")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--no-page", action="store_true", help="write no page")
    try:
        options = parser.parse_args()
        names = options.only or targets()
        if set(names) - set(targets()):
            parser.error("no target is called " + ", ".join(sorted(set(names) - set(targets()))))
    except SystemExit as end:
        return 64 if end.code else 0
    if not has_libfuzzer():
        print("bench fuzz: this clang++ has no libFuzzer", file=sys.stderr)
        return 77 if options.no_page else 2
    folder = os.path.join(ROOT, "build", "fuzz")
    if fault := build(folder, names):
        print(fault, file=sys.stderr)
        return 2
    seed_corpus(folder, names)
    sys.path.insert(0, os.path.join(ROOT, "tests", "figures"))
    import stamp
    # In stamp.PAGES from the first page on: its test asks for the page.
    stamp.PAGES.setdefault("fuzz", stamp.Page("tests/fuzz/RESULTS.md", "./bench fuzz", SOURCES))
    line = stamp.line_of("fuzz", f"seed {options.seed}")
    whole = options.seconds if options.seconds else 60 * options.minutes
    jobs = 2
    seconds = max(1, int(whole * jobs / len(names)))
    rows = []
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for row in pool.map(lambda name: run(folder, name, seconds, options.seed), names):
            rows.append(row)
            print(f"{row['target']:<22} {row['runs']:>10} runs {row['per_s']:>8.0f}/s {row['edges']:>6} edges"
                  + "".join(f"\n  {os.path.join(folder, 'findings', row['target'], name)}" for name in row["found"])
                  + ("" if row["found"] or not row["broke"] else "\n  broke without a file: see its log"), flush=True)
    if not options.only and not options.no_page:
        with open(os.path.join(HERE, "RESULTS.md"), "w", encoding="utf-8") as page:
            page.write(page_of(rows, line, seconds, options.seed))
    return 1 if any(row["broke"] for row in rows) else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"bench fuzz: {error}", file=sys.stderr)
        sys.exit(2)
