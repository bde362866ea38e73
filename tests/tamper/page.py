# SPDX-License-Identifier: Apache-2.0
"""RESULTS.md from the rows of a whole run."""

KINDS = {"time": "Time", "pulses": "Pulses of the drives", "laser": "Laser", "sensors": "Sensors",
         "words": "Words of the controller", "comments": "What nobody reads", "pictures": "Pictures of the kerf",
         "calibrations": "Calibrations", "case": "Board, drawing, machine, release, scenario",
         "results": "A results folder after its verdict"}
FORMS = {"edited": "as edited", "summed": "sum written anew", "foreign": "without our comments", "listed anew": "list written anew, judged again"}
SHOWN = 90


def cell(outcome, base):
    if outcome is None:
        return ""
    if outcome.word == "untouched":
        return "the same file"
    if outcome.word == "FAIL":
        names = ", ".join(outcome.failing[:3])
        return f"FAIL: {names}" + (" …" if len(outcome.failing) > 3 else "")
    if outcome.word == "PASS":
        same = "**the same digests**" if outcome.digests == base else "other digest"
        return f"PASS, {same}" + (f" ({outcome.but})" if outcome.but else "")
    because = outcome.because.replace("|", "/")
    return outcome.word + (f": {because[:SHOWN]}" + ("…" if len(because) > SHOWN else "") if because else "")


def table(rows):
    forms = [form for form in FORMS if any(form in row.outcomes for row in rows)]
    if not forms:
        return ["Nothing to edit."]
    lines = ["| edit | case | " + " | ".join(FORMS[form] for form in forms) + " | why that is right |",
             "|---|---|" + "---|" * (len(forms) + 1)]
    for row in rows:
        cells = " | ".join(cell(row.outcomes.get(form), row.base) for form in forms)
        lines.append(f"| {row.edit.what} (`{row.edit.name}`) | {row.case} | {cells} | {reason(row)} |")
    return lines


def reason(row):
    """Said only where something is accepted."""
    if any(outcome.word == "as written" for outcome in row.outcomes.values()):
        return row.edit.by_sums_alone
    if any(outcome.word == "PASS" for outcome in row.outcomes.values()):
        return row.edit.reason(row.case)
    return ""


def counts(rows):
    outcomes = [(outcome, row.base) for row in rows for outcome in row.outcomes.values() if outcome.word != "untouched"]
    words = {}
    for outcome, base in outcomes:
        word = outcome.word
        if word == "PASS":
            word = "PASS with the same digests" if outcome.digests == base else "PASS with another digest"
        words[word] = words.get(word, 0) + 1
    return len(outcomes), ", ".join(f"{count} {word}" for word, count in sorted(words.items(), key=lambda item: -item[1]))


def page_of(rows, made_with):
    rows = [row for row in rows if row.outcomes]
    evidence = [row for row in rows if row.kind != "results"]
    results = [row for row in rows if row.kind == "results"]
    edits = {row.edit.name for row in rows}
    lines = ["<!-- SPDX-License-Identifier: Apache-2.0 -->", "<!-- Written by ./bench tamper: do not edit. -->",
             "# Evidence that was tampered with", "",
             f"{len(edits)} edits in {len({row.kind for row in rows})} kinds. Judged again, {counts(evidence)[0]} pieces of tampered "
             f"evidence: {counts(evidence)[1]}. Results folders asked about, {counts(results)[0]}: {counts(results)[1]}. Fast "
             "twin.", "", made_with, "",
             "Cases: `moving` is native/label-on-belt with one unit; `rest` is native/button with five of its entities, `photographed` the "
             "same with the pictures of its kerf as files. Pins are handed in as edited (`moving` only), with their sum written anew as "
             "anybody can write it, and without any comment of ours, as a recording of another program. A results folder is asked about "
             "with its own sums alone, then with its list written anew, judged again, and with the digest that was kept.", "",
             "**What a digest is not.** Sums and digests tell that something was changed; they do not tell by whom. Whoever can write "
             "a recording can write its sum, and evidence that is consistent with a good machine is judged as such: PASS, with "
             "another digest. So keep the digest of a release's run where those who could want another verdict cannot write."]
    for kind, heading in KINDS.items():
        of_kind = [row for row in rows if row.kind == kind]
        if of_kind:
            lines += ["", f"## {heading}", ""] + table(of_kind)
    return "\n".join(lines) + "\n"
