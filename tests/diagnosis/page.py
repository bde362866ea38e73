# SPDX-License-Identifier: Apache-2.0
"""What the records of a campaign come to: right causes, sizes, inventions, and the page with the confusion matrix."""
import collections

GOALS = {"cause": 0.95, "size": 0.90, "pair": 0.80, "good": 300}


def kind_of(record):
    return record["name"].rsplit("-", 1)[0]


def is_good(record):
    return not record["true"]


def is_pair(record):
    return len(record["true"]) == 2


def first(record):
    return record["causes"][0]["cause"] if record["causes"] else "none"


def counts(record):
    """A fault that is not proven, because a machine's own departures hide it, has nothing to be explained."""
    return record["verdict"] in ("FAIL", "INVALID")


def is_right(record):
    """The right cause first; of a pair both among the first two; of a good run nothing."""
    if is_good(record):
        return not record["causes"]
    named = [c["cause"] for c in record["causes"]]
    if is_pair(record):
        return set(named[:2]) == {cause for cause, _ in record["true"]}
    return named[:1] == [record["true"][0][0]]


def is_told(record):
    """The same, where a cause also counts that is named as not to be told from the one in its place."""
    if is_right(record) or is_good(record) or not record["causes"]:
        return is_right(record)
    true = {cause for cause, _ in record["true"]}
    said = [{c["cause"], *c["not_told_from"]} for c in record["causes"][:len(true)]]
    return len(said) == len(true) and all(any(cause in names for names in said) for cause in true)


def size_of(record):
    """Measured, U and true size of the first cause; None where it has none."""
    cause, true = record["true"][0]
    if true is None or not record["causes"] or record["causes"][0]["cause"] != cause:
        return None
    named = record["causes"][0]
    return named["size"], named["expanded_uncertainty"], true


def is_within(size):
    measured, U, true = size
    # Offsets have no sign; a hidden 1e-9 is rounding.
    return min(abs(measured - true), abs(abs(measured) - abs(true)) if measured * true > 0 else float("inf")) <= U + 1e-9


def line_of(record):
    true = ", ".join(cause + ("" if size is None else f" {size:.4g}") for cause, size in record["true"]) or "nothing"
    named = ", ".join(f"{c['cause']} {c['size'] or 0:.4g} ± {c['expanded_uncertainty'] or 0:.2g}" for c in record["causes"]) or "none"
    mark = "right" if is_right(record) else "WRONG"
    size = size_of(record) if len(record["true"]) == 1 else None
    if size is not None and not is_within(size):
        mark += ", SIZE"
    return f"{record['name']} ({record['place']}) {record['verdict']}: {true}; said {named}: {mark}"


def shares(records):
    faults = [r for r in records if len(r["true"]) == 1 and counts(r)]
    sizes = [s for s in (size_of(r) for r in faults) if s is not None]
    pairs = [r for r in records if is_pair(r) and counts(r)]
    good = [r for r in records if is_good(r)]
    return {"faults": len(faults), "right": sum(map(is_right, faults)), "sizes": len(sizes), "within": sum(map(is_within, sizes)),
            "pairs": len(pairs), "both": sum(map(is_right, pairs)), "good": len(good), "invented": sum(not is_right(r) for r in good),
            "told": sum(map(is_told, faults)), "both_told": sum(map(is_told, pairs)), "kinds": len({kind_of(r) for r in faults}), "passed": sum(1 for r in records if r["true"] and r["verdict"] == "PASS"),
            "unproven": sum(1 for r in records if r["true"] and r["verdict"] == "NOT PROVEN"),
            "unproven_right": sum(1 for r in records if r["true"] and r["verdict"] == "NOT PROVEN" and is_right(r))}


def percent(part, whole):
    return f"{100.0 * part / whole:.1f} %" if whole else "–"


def summary_of(records):
    s = shares(records)
    return (f"{s['faults']} faults of {s['kinds']} kinds: right cause first {s['right']} ({percent(s['right'], s['faults'])}), size within its U "
            f"{s['within']} of {s['sizes']} ({percent(s['within'], s['sizes'])}); {s['pairs']} pairs: both {s['both']} "
            f"({percent(s['both'], s['pairs'])}); {s['good']} good runs: {s['invented']} with an invented cause; "
            f"not counted: {s['passed']} faults that passed, {s['unproven']} NOT PROVEN ({s['unproven_right']} right)")


def matrix_of(records):
    """Rows: what was put in; columns only where something else than the right cause was named."""
    rows = collections.defaultdict(collections.Counter)
    sizes = collections.defaultdict(list)
    for record in records:
        if len(record["true"]) != 1 or not counts(record):
            continue
        rows[kind_of(record)]["right" if is_right(record) else first(record)] += 1
        if (size := size_of(record)) is not None:
            sizes[kind_of(record)].append(is_within(size))
    others = sorted({named for row in rows.values() for named in row} - {"right"})
    lines = ["| put in | runs | right cause first | size within U | " + " | ".join(f"`{o}`" for o in others) + " |",
             "|---|---|---|---|" + "---|" * len(others)]
    for kind in sorted(rows):
        row = rows[kind]
        held = f"{sum(sizes[kind])} of {len(sizes[kind])}" if sizes[kind] else "–"
        lines.append(f"| `{kind}` | {sum(row.values())} | {row['right']} | {held} | "
                     + " | ".join(str(row[o] or "") for o in others) + " |")
    return lines


def good_goal(s):
    if s["invented"]:
        return "not met"
    return "met" if s["good"] >= GOALS["good"] else f"none so far: {GOALS['good']} are asked for"


def page_of(records, made_with, again=False):
    s = shares(records)
    wrong = [r for r in records if not is_right(r) and (is_good(r) or counts(r))]
    off = [r for r in records if len(r["true"]) == 1 and counts(r) and (z := size_of(r)) is not None and not is_within(z)]
    goal = lambda part, whole, share: "met" if whole and part >= share * whole else "not met"
    return "\n".join([
        "<!-- SPDX-License-Identifier: Apache-2.0 -->", "<!-- Written by ./bench diagnoses: do not edit. -->",
        "# Is the named cause the right one?", "", made_with, "",
        "Faults of known kind and size are put into program, machine file, scenario or recorded pins, never into a measurement; the machine is "
        "drawn around its description (`--imperfections dynamic`). Sizes are 1.1 to 4 times the limit that they break. How a cause is found: "
        "[decision 075](decisions/075-causes-from-stages.md). Kinds: `tests/diagnosis/kinds.py`.", "",
        "| | runs | found | goal | |", "|---|---|---|---|---|",
        f"| right cause first | {s['faults']} of {s['kinds']} kinds | {percent(s['right'], s['faults'])} | 95 % | {goal(s['right'], s['faults'], GOALS['cause'])} |",
        f"| size within its U | {s['sizes']} | {percent(s['within'], s['sizes'])} | 90 % | {goal(s['within'], s['sizes'], GOALS['size'])} |",
        f"| two faults at once, both named | {s['pairs']} | {percent(s['both'], s['pairs'])} | 80 % | {goal(s['both'], s['pairs'], GOALS['pair'])} |",
        f"| good runs with an invented cause | {s['good']} | {s['invented']} | 0 | {good_goal(s)} |", "",
        "Causes that a run cannot tell apart (a late belt and a print mark elsewhere at one speed) are named with the first. With these counted "
        f"as right: {percent(s['told'], s['faults'])} of the faults, {percent(s['both_told'], s['pairs'])} of the pairs.", "",
        f"Not counted are runs that did not FAIL, because the machine's own departures hid the fault: {s['passed']} that passed, and "
        f"{s['unproven']} NOT PROVEN, of which {s['unproven_right']} named the right cause. Good runs are counted whatever their verdict.", "",
        *(["The evidence of the runs was kept, and diagnosed again by the program of this commit.", ""] if again else []),
        "## Confusion matrix", "", *matrix_of(records), "",
        "## What was wrong", "", *([f"- {line_of(r)}" for r in wrong] or ["Nothing."]), "",
        "## Sizes beyond their U", "", *([f"- {line_of(r)}" for r in off] or ["None."]), ""])
