# SPDX-License-Identifier: Apache-2.0
"""The bench as a user has it: target, calibration from pictures, a run, replays with folders of pictures, verdicts."""
import json
import os
import re
import subprocess

import pictures
import scenes
import sheet as sheets
from tracer import Broken

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DATE = "2026-11-23"
VERDICTS = (0, 1, 3, 4)         # Exit codes of a run that has a verdict.


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


class Kerfbench:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def call(self, *arguments, good=(0,)):
        done = subprocess.run([self.program, *arguments], capture_output=True, text=True, cwd=self.folder, check=False)
        if done.returncode not in good:
            raise Broken(f"kerfbench {' '.join(arguments)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout


def write_machine(bench, lens):
    """The stock machine with this camera over the inspection table, square pixels and no distortion."""
    camera = lens.camera
    return write(bench.path(f"{lens.name}.yaml"), (
        f"extends: {ROOT}/fixtures/machines/two-mirror.yaml\nname: {lens.name}\ncameras:\n"
        f"  spot: {{calibration: {ROOT}/fixtures/machines/two-mirror.spot.camera.yaml}}\n"
        f"  kerf: {{id: witness-{lens.name}, calibration: {lens.name}.kerf.camera.yaml, size_px: {list(camera.size_px)},\n"
        f"    lens: {lens.kind}, pitch_mm: {camera.pitch_mm}, height_mm: {camera.height_mm}, tilt_deg: {camera.tilt_deg},\n"
        f"    distortion: [0, 0, 0, 0, 0]}}\n"))


def calibrate(bench, tracer, lens):
    """The camera from rendered views of the target that the bench writes; what the bench says of it."""
    machine = write_machine(bench, lens)
    svg = bench.path(lens.name, "target.svg")
    os.makedirs(bench.path(lens.name, "views"), exist_ok=True)
    bench.call("calibrate", "target", "--machine", machine, "--camera", "kerf", "--out", svg, *lens.target)
    description = svg[:-4] + ".yaml"
    target = scenes.read_target(*(open_text(path) for path in (svg, description)))
    bitmap = scenes.target_bitmap(target)
    for number, view in enumerate(lens.views):
        scene = scenes.target_scene(lens.camera, target, view, "target.pgm")
        clean = tracer.picture(f"{lens.name}, view {number}", scene, lens.camera.size_px, bitmap)
        pictures.write_png(bench.path(lens.name, "views", f"view-{number:02}.png"),
                           pictures.exposed(clean, tracer.sensor, 1000 + number))
    x, y = target.origin_mm(lens.views[0])
    bench.call("calibrate", "camera", "--machine", machine, "--camera", "kerf", "--date", DATE, "--views",
               bench.path(lens.name, "views"), "--target", description, "--origin-mm", f"{x:.9f}", f"{y:.9f}", "--turn-deg",
               f"{lens.views[0].turn_deg:g}", "--jobs", "1")
    made = open_text(bench.path(f"{lens.name}.kerf.camera.yaml"))
    return {key: float(re.search(rf"^{key}: (\S+)", made, re.M).group(1)) for key in ("rms_px", "map_u_mm")}


def open_text(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def write_job(bench, sheet):
    """The job as the machine runs it, with the model's own pictures: its pins are what replays judge."""
    dx, dy = sheet.p_SU_mm
    marks = "".join(f"    - {{x_mm: {x + dx:g}, y_mm: {y + dy:g}, diameter_mm: {sheet.mark_mm:g}}}\n" for x, y in sheet.marks)
    write(bench.path("sheet.dxf"), sheets.dxf(sheet))
    return write(bench.path("job.yaml"), (
        f"extends: {ROOT}/fixtures/scenarios/native/label-on-belt.yaml\nname: job\ntitle: Witness sheet\n"
        "dieline: sheet.dxf\nbelt: {speed_mm_s: 30}\n"
        f"print:\n  units: 1\n  pitch_mm: 70\n  eye_mark_x_mm: 4\n  eye_mark_length_mm: 4\n  marks:\n{marks}"))


def run_job(bench, sheet):
    """Recorded pins of the job."""
    bench.call("run", write_job(bench, sheet), "--no-pictures", "--twin", "fast", "--jobs", "1", "--results-dir",
               bench.path("results"), good=VERDICTS)
    return bench.path("results", "job", "latest", "pins.vcd")


def judge(bench, sheet, lens, case, picture, name, pins):
    """verdict.json of the job with this picture of the kerf."""
    folder = bench.path(lens.name, name)
    os.makedirs(folder, exist_ok=True)
    pictures.write_png(os.path.join(folder, "tile.png"), picture)
    x, y = sheet.p_SU_mm
    write(os.path.join(folder, "tiles.yaml"), f"version: 1\ntiles:\n  - {{file: tile.png, p_TV_mm: [{x:g}, {y:g}]}}\n")
    write(bench.path(f"{lens.name}-{name}.machine.yaml"),
          f"extends: {lens.name}.yaml\nbeam: {{waist_radius_mm: {case.told_radius_mm:.9g}}}\n")
    scenario = write(bench.path(f"{lens.name}-{name}.yaml"), (
        f"extends: job.yaml\nname: {lens.name}-{name}\ndate: {DATE}\nmachine: {lens.name}-{name}.machine.yaml\n"
        f"board: {{thickness_mm: {case.told_thickness_mm():g}}}\n"
        f"cameras: {{kerf: {{source: tiles, folder: {lens.name}/{name}}}}}\n"))
    bench.call("replay", pins, "--scenario", scenario, "--no-pictures", "--twin", "fast", "--jobs", "1", "--results-dir",
               bench.path("results"), good=VERDICTS)
    with open(bench.path("results", f"{lens.name}-{name}-replay", "latest", "verdict.json"), encoding="utf-8") as file:
        return json.load(file)
