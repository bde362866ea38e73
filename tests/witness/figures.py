# SPDX-License-Identifier: Apache-2.0
"""What the bench said against what is true: errors in micrometres with their places, and tables of them."""
import dataclasses
import math
import statistics

import beam
import sheet as sheets

RINGS_MM = ((0, 10), (10, 20), (20, 35))
COVER_GOAL = 0.9                # Least share of a kind's readings within their U.
# Readings with a goal: what each is called, and the largest error that it may have.
GOALS = {"lines": {"line": ("line", 5.0)}, "widths": {"width": ("width", math.inf)},
         "corners": {"corner": ("corner, deviation", 10.0), "rounding": ("corner, rounding", 10.0),
                     "overshoot": ("corner, overshoot", 10.0)},
         "ends": {"end_gap": ("end", 10.0), "closure": ("closure", 10.0)}}


@dataclasses.dataclass(frozen=True)
class Reading:
    kind: str
    error_um: float             # What is said less what is true; of lines positive away from the middle of the picture.
    U_um: float
    place_mm: tuple             # On the table, from what the middle of the picture sees.
    walls_um: float = 0.0       # Of lines: what upright walls do to the middle that is seen.

    def radius_mm(self):
        return math.hypot(*self.place_mm)


def seen_from(camera, lay, point, normal):
    """Place on the table; +1 if the normal points away from the middle of the picture, else -1; and the tangent of the
    angle at which the camera looks across the normal, outwards."""
    place, ahead = lay.place(point), lay.place((point[0] + normal[0], point[1] + normal[1]))
    turned = (ahead[0] - place[0], ahead[1] - place[1])
    sign = math.copysign(1.0, place[0] * turned[0] + place[1] * turned[1])
    slope = camera.slope(place)
    return place, sign, sign * (slope[0] * turned[0] + slope[1] * turned[1])


def sideways(said, truth_mm):
    """RMS of an offset less the known one, in the direction of the normal."""
    return math.copysign(1.0, truth_mm) * (said - abs(truth_mm))


def readings(verdict, sheet, lens, board, lay):
    """Everything that verdict.json says of lines, widths and joints."""
    found, drawn = [], sheets.entities(sheet)
    for said in verdict["entities"]:
        entity = drawn[said["entity"]]
        if said["worst_mm"] is None:
            found.append(Reading("lost", 0.0, 0.0, lay.place(entity.start[:2])))
            continue
        point, normal = entity.at(said["worst_u"])
        place, sign, tangent = seen_from(lens.camera, lay, point, normal)
        # Along a line or an arc both are the same everywhere, but at its very end, where there may be no slit.
        middle, width = beam.middle_and_width(entity.path, *entity.at(0.5), 0.5 * board.half_light_mm())
        walls_um = -0.5e3 * board.thickness_mm * tangent
        side = math.copysign(sign, sign * said["worst_mm"])
        worst_mm = side * (abs(said["worst_mm"]) - abs(middle))
        found.append(Reading("line", 1e3 * worst_mm, 1e3 * said["worst_U_mm"], place, walls_um))
        beside = entity.path.beside_mm
        if beside and not entity.path.radius:
            mean_mm = sideways(said["rms_mm"], beside)
            found.append(Reading("mean", 1e3 * sign * mean_mm, 1e3 * said["rms_U_mm"], place, walls_um))
        found.append(Reading("width", 1e3 * (said["width_mm"] - width), 1e3 * said["width_U_mm"], place))
    for said in verdict["joints"]:
        place = lay.place((said["x_mm"] - sheet.p_SU_mm[0], said["y_mm"] - sheet.p_SU_mm[1]))
        if said["value"] is None:
            found.append(Reading("lost", 0.0, 0.0, place))
        else:
            found.append(Reading(said["kind"], 1e3 * said["value"], 1e3 * said["U"], place))
    return found


@dataclasses.dataclass(frozen=True)
class Summary:
    number: int
    bias_um: float
    sd_um: float
    worst: Reading
    U_um: float                 # Median.
    cover: float


def summary(chosen):
    errors = [r.error_um for r in chosen]
    inside = sum(1 for r in chosen if abs(r.error_um) <= r.U_um)
    scatter = statistics.stdev(errors) if len(errors) > 1 else 0.0
    return Summary(len(chosen), statistics.fmean(errors), scatter,
                   max(chosen, key=lambda r: abs(r.error_um)), statistics.median(r.U_um for r in chosen), inside / len(chosen))


def of_kind(found, kind, ring=(0, math.inf)):
    return [r for r in found if r.kind == kind and ring[0] <= r.radius_mm() < ring[1]]


def cells(of):
    x, y = of.worst.place_mm
    return (f"{of.number} | {of.bias_um:+.2f} | {of.sd_um:.2f} | {of.worst.error_um:+.2f} | {x:.0f}, {y:.0f} | {of.U_um:.2f} | "
            f"{100 * of.cover:.0f} %")


HEAD = "| n | bias | sd | worst | at, mm | U | cover |"


def goal_table(results):
    """Which quantities keep to their goals."""
    rows = [f"| lens | board, mm | {' | '.join(GOALS)} |", "|---|---|" + "---|" * len(GOALS)]
    for (lens, board), found in results.items():
        said = ("**fail**" if missed(found, quantity) else "hold" for quantity in GOALS)
        rows.append(f"| {lens} | {board} | {' | '.join(said)} |")
    return rows


def kind_table(results, quantity):
    rows = [f"| what | lens | board, mm {HEAD} goals |", "|---|---|---|" + "---|" * 8]
    for kind, (title, worst_um) in GOALS[quantity].items():
        for (lens, board), found in results.items():
            chosen = of_kind(found, kind)
            if chosen:
                of = summary(chosen)
                said = "hold" if keeps(of, worst_um) else "**fail**"
                rows.append(f"| {title} | {lens} | {board} | {cells(of)} | {said} |")
    return rows


def walls_table(results):
    """Means of straight lines, and what is left of them without the shift that upright walls make."""
    rows = ["| lens | board, mm | n | bias | worst | U | left: bias | left: sd | left: worst |", "|---|---|" + "---|" * 7]
    for (lens, board), found in results.items():
        chosen = of_kind(found, "mean")
        of, left = (summary([dataclasses.replace(r, error_um=r.error_um - share * r.walls_um) for r in chosen])
                    for share in (0.0, 1.0))
        rows.append(f"| {lens} | {board} | {of.number} | {of.bias_um:+.2f} | {of.worst.error_um:+.2f} | {of.U_um:.2f} | "
                    f"{left.bias_um:+.2f} | {left.sd_um:.2f} | {left.worst.error_um:+.2f} |")
    return rows


def ring_table(results):
    titles = [f"{a} … {b} mm: bias | worst | cover" for a, b in RINGS_MM]
    rows = [f"| lens | board, mm | {' | '.join(titles)} |", "|---|---|" + "---|" * 3 * len(RINGS_MM)]
    for (lens, board), found in results.items():
        row = []
        for ring in RINGS_MM:
            chosen = of_kind(found, "line", ring)
            of = summary(chosen) if chosen else None
            row.append(f"{of.bias_um:+.2f} | {of.worst.error_um:+.2f} | {100 * of.cover:.0f} %" if of else "– | – | –")
        rows.append(f"| {lens} | {board} | {' | '.join(row)} |")
    return rows


def keeps(of, worst_um):
    return of.cover >= COVER_GOAL and abs(of.worst.error_um) <= worst_um


def missed(found, quantity):
    """A sentence for each kind of reading of this quantity that misses a goal."""
    complaints = []
    for kind, (title, worst_um) in GOALS[quantity].items():
        chosen = of_kind(found, kind)
        if chosen and not keeps(summary(chosen), worst_um):
            complaints.append(f"{title}: {told(chosen)}")
    lost = len(of_kind(found, "lost"))
    return complaints + ([f"{lost} lines and joints not found"] if lost else [])


def told(chosen):
    of = summary(chosen)
    x, y = of.worst.place_mm
    return (f"{of.number} read, bias {of.bias_um:+.2f} um, worst {of.worst.error_um:+.2f} at {x:.0f}, {y:.0f} mm, "
            f"U {of.U_um:.2f}, cover {100 * of.cover:.0f} %")


def failing(results):
    """Sentences for all goals that are missed."""
    return [f"{lens}, board {board}: {complaint}" for (lens, board), found in results.items()
            for complaint in dict.fromkeys(c for quantity in GOALS for c in missed(found, quantity))]


def beyond(results, allowed_um):
    """Readings of a quick run that are lost, or lie farther off than their U and this."""
    kinds = [kind for quantity in GOALS.values() for kind in quantity]
    return [f"{lens}, board {board}: {r.kind} at {r.place_mm[0]:.1f}, {r.place_mm[1]:.1f}: {r.error_um:+.2f} um, "
            f"U {r.U_um:.2f}" for (lens, board), found in results.items() for r in found
            if r.kind == "lost" or r.kind in kinds and abs(r.error_um) > r.U_um + allowed_um]
