# SPDX-License-Identifier: Apache-2.0
"""RESULTS.md: tables, and sentences that are true of whatever was measured."""
import os

import figures

INTRODUCTION = """\
Sheets and calibration targets are rendered by POV-Ray from the pose of the kerf camera: boards with walls, light by Beer's
law at 12 %, an even back light, the target from the SVG of `calibrate target`. Blur (Gaussian, 0.7 px), pixels, noise and
8 bits are made by `tests/witness/pictures.py`. Then all goes the way of a user's pictures: `calibrate camera --views`,
`replay` with `cameras: {{kerf: {{source: tiles}}}}`, verdict.json. Nothing of the model's camera takes part. The camera is
the stock one without distortion, rolled by 6.5 degrees: 2048 x 1536 pixels of 0.03 mm, 300 mm above the sheet, leaning by
0.5 degrees. The top of the board lies in the calibrated plane. Each row is {sheets} pictures: {lays} lays of the sheet, {seeds} seeds of noise each.
Commit {commit}, seeds {seed_list}, by `./bench witness`. Figures are in µm; U is the median of what the bench states
(k = 2), cover the share of errors within their own U."""

LINES = """\
`worst_mm` of each entity (lines, arcs, a circle) against the true middle of its slit; free lines and the circle are cut
20 µm beside the drawing, so the truth is not 0. Positive: outwards, away from the middle of the picture. Goals: cover of
90 %, no error above 5 µm."""

WALLS = """\
`rms_mm` of the free straight lines against the 20 µm by which they are cut beside the drawing. A camera that looks at a
slit with upright walls at an angle sees its middle t tan(angle) / 2 nearer to the camera's foot. What is left without that
shift shows how well it explains the error, and what a correction by thickness alone can reach."""

OTHERS = """\
Without a goal. True width: where half of the light comes through, straight down. Corners are sharp paths of a round tool:
deviation, rounding and overshoot are truly 0. A round end is where the middle of the tool was, a flat end where the slit
ends; a negative error says that the bench takes the line for too long. The bench presumes the groove of a Gaussian beam
(`beam.waist_radius_mm`); these slits have sharp edges."""


def save(path, text):
    with open(path + ".new", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(path + ".new", path)


def names(rows):
    return "; ".join(f"{lens} {board}" for lens, board in rows) or "none"


def notes(calibrations):
    return [f"Calibration, {name}: residual {made['rms_px']:.4f} px, stated uncertainty of a place "
            f"{1e3 * made['map_u_mm']:.3f} µm (k = 1)." for name, made in calibrations.items()]


def text(plan, results, calibrations, commit):
    missed = figures.failing(results)
    introduction = INTRODUCTION.format(sheets=len(plan.lays) * len(plan.seeds), lays=len(plan.lays), seeds=len(plan.seeds),
                                       seed_list=", ".join(map(str, plan.seeds)), commit=commit)
    lines = ["<!-- SPDX-License-Identifier: Apache-2.0 -->", "<!-- Written by ./bench witness: do not edit. -->",
             "# The kerf in another program's pictures", "", introduction, "",
             f"**Goals of lines hold for:** {names(row for row in results if row not in missed)}. "
             f"**They fail for:** {names(missed)}.", ""]
    for note in notes(calibrations):
        lines += [note, ""]
    lines += ["## Lines", "", LINES, "", *figures.line_table(results), "",
              "The same by the distance of the worst place from the middle of the picture:", "",
              *figures.ring_table(results), "",
              "## Walls", "", WALLS, "", *figures.walls_table(results), "",
              "## Widths, corners, ends", "", OTHERS, "", *figures.other_table(results)]
    return "\n".join(lines) + "\n"
