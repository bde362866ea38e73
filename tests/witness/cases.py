# SPDX-License-Identifier: Apache-2.0
"""What is measured: lenses, boards, how sheets lie, seeds of the noise. Add a row here to have it measured."""
import dataclasses

import beam
import sheet
from scenes import Board, Camera, Lay, View

BESIDE_MM = 0.02                # How far free lines and circles are cut beside the drawing: a truth that is not 0.


@dataclasses.dataclass(frozen=True)
class Lens:
    """A camera as rendered, the views that it is calibrated by, and what the bench is told of it."""
    name: str
    camera: Camera
    views: tuple
    kind: str = "entocentric"   # As the machine file has it.
    target: tuple = ()          # Arguments of `calibrate target`.


@dataclasses.dataclass(frozen=True)
class Case:
    """A board, and what the bench is told of it and of the beam."""
    board: Board
    told_radius_mm: float = beam.RADIUS_MM
    lays: int = 3               # How many of the plan's are looked at.

    def told_thickness_mm(self):
        """The bench takes none below a micrometre."""
        return max(self.board.thickness_mm, 0.001)


@dataclasses.dataclass(frozen=True)
class Plan:
    """A sheet, and all ways in which it is measured."""
    sheet: sheet.Sheet
    lenses: tuple
    boards: dict                # Cases by name.
    lays: tuple
    seeds: tuple


TILTED = (View(13, 24, 0, 3, -2, 10), View(-14, 28, 43, -4, 3, -12), View(18, 32, 85, 2, 4, 5), View(-17, 36, 128, 5, -3, -6),
          View(12, 21, 170, -6, 1, 14), View(101, 30, 212, 1, -4, 0), View(-15, 34, 250, -2, 2, -9))

ENTOCENTRIC = Lens("entocentric", Camera((2048, 1536)), (View(0),) + TILTED)
TELECENTRIC = Lens("telecentric", Camera((2048, 1536), telecentric=True), (View(0),) + TILTED, kind="telecentric")

BOARDS = {"0": Case(Board(0.0)), "0.1": Case(Board(0.1)), "0.4": Case(Board(0.4)),
          # Its stairs take three times as long to render.
          "0.4 tapered": Case(Board(0.4, bottom_mm=0.11, top_mm=0.15), lays=1),
          # As wrong as the stock machine file says that the beam may be told (waist_radius_percent).
          "0.1 beam 3 % off": Case(Board(0.1), told_radius_mm=1.03 * beam.RADIUS_MM)}
LAYS = (Lay(0.62, 0.31, -0.22), Lay(-1.13, -0.27, 0.41), Lay(1.37, 0.08, 0.15))

FULL = Plan(sheet.full_sheet(BESIDE_MM), (ENTOCENTRIC, TELECENTRIC), BOARDS, LAYS, (1, 2))
# A camera of 640 x 480 pixels: 22 x 16 mm, near enough that the wall of a thin board shows.
SMALL = Lens("small", Camera((640, 480), pitch_mm=0.034, height_mm=100.0), (View(0),) + tuple(
    dataclasses.replace(view, x_mm=0.2 * view.x_mm, y_mm=0.2 * view.y_mm, z_mm=0.2 * view.z_mm) for view in TILTED[:4]))
QUICK = Plan(sheet.small_sheet(BESIDE_MM), (SMALL,), {"0.1": BOARDS["0.1"]}, LAYS[:1], (1,))

# What a quick run allows beyond U: its pixels are larger over a camera that is nearer.
QUICK_ALLOWS_UM = 1.5
