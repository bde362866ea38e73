#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The witness's own slits: fluence against a spot that is moved by hand, and solids as POV-Ray shows them."""
import math
import tempfile
import unittest

import numpy

import beam
import pictures
import scenes
import sheet
from tracer import Tracer

BENT = sheet.Path(((-2.0, -1.0, 0.0), (0.0, 0.0, 0.0), (1.0, -2.0, 0.0)))
ROUND = sheet.Path(((-2.0, 1.0, 0.0), (0.0, 1.0, sheet.QUARTER_BULGE), (2.0, 3.0, 0.0), (2.0, 4.5, 0.0)))
RING = sheet.circle(-2.0, 3.5, 0.8, beside_mm=0.02)
PIXEL_MM = 0.003
ROUNDING_MM = 2e-4              # How far an outline may lie off.
STAIRS = 0.02                   # Light that leaning walls in stairs may be off by.


def by_hand(way, x, y):
    """A Gaussian spot set down every micrometre of a way, given as points."""
    total = 0.0
    for (x0, y0), (x1, y1) in zip(way, way[1:]):
        length = math.hypot(x1 - x0, y1 - y0)
        count = math.ceil(length / 0.001)
        for share in (numpy.arange(count) + 0.5) / count:
            square = (x - x0 - share * (x1 - x0)) ** 2 + (y - y0 - share * (y1 - y0)) ** 2
            total = total + length / count * numpy.exp(-2.0 * square / beam.RADIUS_MM ** 2)
    return total * math.sqrt(2.0 / math.pi) / beam.RADIUS_MM


def places(x, y, half_mm, step_mm):
    across = numpy.arange(-half_mm, half_mm, step_mm) + 0.5 * step_mm
    return numpy.meshgrid(x + across, y - across)


class Fluence(unittest.TestCase):
    def assert_as_by_hand(self, path, way, x, y):
        where = places(x, y, 0.3, 0.02)
        error = numpy.abs(beam.fluence(beam.pieces(path), *where) - by_hand(way, *where)).max()
        self.assertLess(error, 1e-5)

    def test_is_that_of_a_spot_that_runs_around_a_corner(self):
        self.assert_as_by_hand(BENT, [point[:2] for point in BENT.points], 0.0, 0.0)

    def test_is_that_of_a_spot_that_runs_into_an_arc(self):
        turn = [(2.0 * math.sin(a), 3.0 - 2.0 * math.cos(a)) for a in numpy.linspace(0.0, 0.5 * math.pi, 1001)]
        self.assert_as_by_hand(ROUND, [(-2.0, 1.0), *turn, (2.0, 4.5)], 0.0, 1.0)

    def test_is_that_of_a_spot_that_runs_round_a_circle_beside_the_drawn_one(self):
        turn = [(-2.0 + 0.78 * math.cos(a), 3.5 + 0.78 * math.sin(a)) for a in numpy.linspace(0.0, 2.0 * math.pi, 2001)]
        self.assert_as_by_hand(RING, turn, -1.22, 3.5)

    def test_ends_where_half_of_the_beam_no_longer_cuts(self):
        half_mm = 0.065
        line = beam.Straight((-3.0, 0.0), (0.0, 0.0))
        reach_mm = beam.distance_to([line], (-0.1, 0.0), (1.0, 0.0), half_mm) - 0.1
        self.assertAlmostEqual(0.5 * math.erfc(math.sqrt(2.0) * reach_mm / beam.RADIUS_MM), beam.level(half_mm), places=6)


class Solids(unittest.TestCase):
    """Looked at square from above, in pixels that are much smaller than a slit."""

    def shown(self, board, x, y, *paths):
        """The light of each pixel, and the fluence there."""
        camera = scenes.Camera((200, 200), pitch_mm=PIXEL_MM, tilt_deg=0.0, roll_deg=0.0, telecentric=True)
        drawn = sheet.Sheet((5.0, 6.0), paths, (), 1.0, (0.0, 0.0))
        with tempfile.TemporaryDirectory() as folder:
            tracer = Tracer(folder, pictures.Sensor(), lambda text: None, depth=0, per_pixel=1)
            light = tracer.render(scenes.board_scene(camera, drawn, board, scenes.Lay(0.0, -x, -y)), camera.size_px, None)
        where = places(x, y, 100 * PIXEL_MM, PIXEL_MM)
        return light / scenes.LIGHT, beam.fluence([piece for path in paths for piece in beam.pieces(path)], *where)

    def assert_is_the_level_set(self, board, x, y, path):
        light, fluence = self.shown(board, x, y, path)
        least = beam.level(0.5 * board.bottom_mm)
        steep = numpy.hypot(*numpy.gradient(fluence, PIXEL_MM))
        certain = numpy.abs(fluence - least) > ROUNDING_MM * steep
        wanted = numpy.where(fluence >= least, 1.0, scenes.TRANSMISSION)
        self.assertLess(numpy.abs(light - wanted)[certain].max(), 1e-3)
        self.assertGreater(certain.mean(), 0.98)

    def test_are_level_sets_at_ends_corners_arcs_and_circles(self):
        for thickness_mm in (0.0, 0.2):
            for x, y, path in ((-2.0, -1.0, BENT), (0.0, 0.0, BENT), (0.0, 1.0, ROUND), (2.0, 3.4, ROUND),
                               (1.414, 1.586, ROUND), (-1.22, 3.5, RING)):
                with self.subTest(x=x, y=y, thickness_mm=thickness_mm):
                    self.assert_is_the_level_set(scenes.Board(thickness_mm), x, y, path)

    def test_with_leaning_walls_are_level_sets_at_every_depth(self):
        board = scenes.Board(0.2, bottom_mm=0.11, top_mm=0.15)
        for x, y in ((-2.0, -1.0), (0.0, 0.0)):
            with self.subTest(x=x, y=y):
                light, fluence = self.shown(board, x, y, BENT)
                half_mm = beam.RADIUS_MM * numpy.sqrt(-0.5 * numpy.log(numpy.clip(fluence, 1e-9, 1.0)))
                left = numpy.clip((2.0 * half_mm - board.bottom_mm) / (board.top_mm - board.bottom_mm), 0.0, 1.0)
                self.assertLess(numpy.abs(light - scenes.TRANSMISSION ** left).max(), STAIRS)


if __name__ == "__main__":
    unittest.main()
