# SPDX-License-Identifier: Apache-2.0
"""RESULTS.md: tables, and sentences that are true of whatever was measured."""
import beam
import figures

INTRODUCTION = """\
Sheets and calibration targets are rendered by POV-Ray from the pose of the kerf camera: boards with walls, light by Beer's
law at 12 %, an even back light, the target from the SVG of `calibrate target`. The slits are those of a beam
(`tests/witness/beam.py`): level sets of the fluence that a Gaussian beam of {radius_um:.0f} µm (1/e² radius) leaves at constant speed
along lines, arcs and around corners, at the level that makes straight lines {width_um:.0f} µm wide. Walls are upright, those of the
tapered board lean: {top_um:.0f} µm wide at the top, {bottom_um:.0f} µm at the bottom. Blur (Gaussian, 0.7 px), pixels, noise and 8 bits are made by
`tests/witness/pictures.py`. Then all goes the way of a user's pictures: `calibrate camera --views`, `replay` with
`cameras: {{kerf: {{source: tiles}}}}`, verdict.json. Nothing of the model's camera or of its beam takes part. The camera is
the stock one without distortion, rolled by 6.5 degrees: 2048 x 1536 pixels of 0.03 mm, 300 mm above the sheet, leaning by
0.5 degrees. The top of the board lies in the calibrated plane. The bench is told the thickness and the beam's radius, of the
rows *beam 3 % off* a radius that is 3 % too large, which is what the stock machine file says that it may be off (k = 1). Each
row is {sheets} pictures: {lays} lays of the sheet, {seeds} seeds of noise each; of the tapered board one lay. Figures
are in µm; U is the median of what the bench states (k = 2), cover the share of errors within their own U."""

GOALS = """\
Of each quantity at least {cover:.0f} % of the errors lie within their own U, and none is larger than {lines:.0f} µm (lines)
or {joints:.0f} µm (corners, ends); widths have the goal of cover alone. A line or joint that is not found fails all goals of its
row."""

LINES = """\
`worst_mm` of each entity (lines, arcs, a circle) against the true middle of its slit; free lines and the circle are cut
20 µm beside the drawing, so the truth is not 0. U is that of a magnitude, so magnitudes are compared. A bend shifts the slit
of a beam by w²/8R inwards: the truth is that of the slit. Positive: outwards, away from the middle of the picture."""

WALLS = """\
`rms_mm` of the free straight lines against the 20 µm by which they are cut beside the drawing. A camera that looks at a
slit with upright walls at an angle sees its middle t tan(angle) / 2 nearer to the camera's foot. What is left without that
shift shows how well it explains the error, and what a correction by thickness alone can reach."""

WIDTHS = """\
True width: where half of the light comes through, straight down."""

CORNERS = """\
The beam turns sharply, at constant speed: deviation, rounding and overshoot of its path are truly 0. None of the three can
be negative, so noise alone makes a bias."""

ENDS = """\
True is where the beam stopped; a negative error says that the bench takes the line for too long. The slit itself ends {reach}
µm beyond that in the middle, where a hard round tool would reach {tool_um:.0f} µm. The circle is closed: its gap is truly 0."""


def notes(calibrations):
    return [f"Calibration, {name}: residual {made['rms_px']:.4f} px, stated uncertainty of a place "
            f"{1e3 * made['map_u_mm']:.3f} µm (k = 1)." for name, made in calibrations.items()]


def introduction(plan):
    boards = [case.board for case in plan.boards.values()]
    leaning = next(board for board in boards if board.top_mm != board.bottom_mm)
    return INTRODUCTION.format(
        radius_um=1e3 * beam.RADIUS_MM, width_um=1e3 * boards[0].bottom_mm, top_um=1e3 * leaning.top_mm,
        bottom_um=1e3 * leaning.bottom_mm, sheets=len(plan.lays) * len(plan.seeds), lays=len(plan.lays),
        seeds=len(plan.seeds))


def goals():
    worst_um = {kind: worst for kinds in figures.GOALS.values() for kind, (_, worst) in kinds.items()}
    return GOALS.format(cover=100 * figures.COVER_GOAL, lines=worst_um["line"], joints=worst_um["corner"])


def ends(plan):
    """How far slits reach beyond the beam's stop, said for upright walls."""
    half_mm = 0.5 * next(iter(plan.boards.values())).board.bottom_mm
    long = beam.Straight((-10.0, 0.0), (0.0, 0.0))
    reach_um = 1e3 * (beam.distance_to([long], (-beam.END_INSIDE_MM, 0.0), (1.0, 0.0), half_mm) - beam.END_INSIDE_MM)
    return ENDS.format(reach=f"{reach_um:.1f}", tool_um=1e3 * half_mm)


def text(plan, results, calibrations, made_with):
    lines = ["<!-- SPDX-License-Identifier: Apache-2.0 -->", "<!-- Written by ./bench witness: do not edit. -->",
             "# The kerf in another program's pictures", "", introduction(plan), "", made_with, "",
             "## Goals", "", goals(), "", *figures.goal_table(results), ""]
    missed = figures.failing(results)
    lines += ["All goals hold." if not missed else "Missed, with the place of the worst on the table:", ""]
    lines += [f"- {complaint}" for complaint in missed] + ([""] if missed else [])
    for note in notes(calibrations):
        lines += [note, ""]
    lines += ["## Lines", "", LINES, "", *figures.kind_table(results, "lines"), "",
              "The same by the distance of the worst place from the middle of the picture:", "",
              *figures.ring_table(results), "",
              "### Walls", "", WALLS, "", *figures.walls_table(results), ""]
    for quantity, said in (("widths", WIDTHS), ("corners", CORNERS), ("ends", ends(plan))):
        lines += [f"## {quantity.capitalize()}", "", said, "", *figures.kind_table(results, quantity), ""]
    return "\n".join(lines[:-1]) + "\n"
