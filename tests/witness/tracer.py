# SPDX-License-Identifier: Apache-2.0
"""Renders scenes by POV-Ray, and keeps what it rendered under a digest of scene and settings."""
import hashlib
import os
import re
import subprocess
import tempfile

import numpy

import pictures


class Broken(Exception):
    """A program did not do what it should."""


class Tracer:
    """Rays in a grid of 2 x 2 a pixel, and more of them where neighbours differ; none more at depth 0."""

    def __init__(self, cache, sensor, say, depth=4, per_pixel=2):
        self.cache, self.sensor, self.say, self.depth, self.per_pixel = cache, sensor, say, depth, per_pixel
        asked = subprocess.run(["povray", "--version"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                               check=False)
        self.version = "".join(re.findall(r"^POV-Ray .*", asked.stdout + asked.stderr, re.M))
        os.makedirs(cache, exist_ok=True)

    def picture(self, name, scene, size_px, bitmap=None):
        """The picture without noise; `bitmap`: rows for the file target.pgm of the scene."""
        path = os.path.join(self.cache, self.key(scene, size_px, bitmap) + ".npy")
        if not os.path.exists(path):
            self.say(f"{name}: rendering")
            clean = pictures.pixels(self.render(scene, size_px, bitmap), self.per_pixel, self.sensor)
            with open(path + ".new", "wb") as file:
                numpy.save(file, clean)
            os.replace(path + ".new", path)
        return numpy.load(path)

    def key(self, scene, size_px, bitmap):
        settings = f"{self.version} {pictures.VERSION} {size_px} {self.per_pixel} {self.depth} {self.sensor.blur_px}"
        drawn = b"".join(bytes(row) for row in bitmap or [])
        return hashlib.sha256(b"\0".join([scene.encode(), settings.encode(), drawn])).hexdigest()[:24]

    def render(self, scene, size_px, bitmap):
        with tempfile.TemporaryDirectory(dir=self.cache) as folder:
            with open(os.path.join(folder, "scene.pov"), "w", encoding="utf-8") as file:
                file.write(scene)
            if bitmap:
                pictures.write_pgm(os.path.join(folder, "target.pgm"), bitmap)
            wide, tall = (self.per_pixel * n for n in size_px)
            more = ["+AM2", "+A0.02", f"+R{self.depth}"] if self.depth else ["-A"]
            rays = [f"+W{wide}", f"+H{tall}", "+WT1", *more, "-J", "-D", "-V", "-UR"]   # -UR: keeps `bounded_by`.
            grey = ["Output_File_Type=P", "Grayscale_Output=on", "Bits_Per_Color=16", "File_Gamma=1.0", "+Oscene"]
            done = subprocess.run(["povray", "scene.pov", *rays, *grey], cwd=folder, stdin=subprocess.DEVNULL,
                                  capture_output=True, text=True, errors="replace", check=False)
            written = os.path.join(folder, "scene.ppm")     # So named, although it is a PGM.
            if done.returncode or not os.path.exists(written):
                raise Broken(f"povray ended with {done.returncode}:\n{done.stderr[-2000:]}")
            return pictures.read_pgm(written)
