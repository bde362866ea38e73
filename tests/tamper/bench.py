# SPDX-License-Identifier: Apache-2.0
"""The bench as a user has it: good cases are recorded once, then judged again with whatever was tampered with."""
import json
import os
import re
import shutil
import subprocess
import tempfile

import pin_edits
import result_edits
from recording import Recording

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FIXTURES = os.path.join(ROOT, "fixtures")
VERDICTS = (0, 1, 3, 4)     # Exit codes of a run that has a verdict.
REFUSED = 65


def marks(*places):
    return "[" + ", ".join(f"{{x_mm: {x}, y_mm: {y}}}" for x, y in places) + "]"


# Everything that is edited lies beside the scenario, or stands in it.
MOVING = f"""extends: {FIXTURES}/scenarios/native/label-on-belt.yaml
name: moving
twin: fast
date: 2026-11-23
dieline: drawing.dxf
machine: machine.yaml
belt: {{speed_mm_s: 60, profile: constant}}
print: {{units: 1, marks: {marks((-55, -27), (-55, 27), (-5, -27), (-5, 27), (-20, 27))}}}
"""
MOVING_MACHINE = f"""extends: {FIXTURES}/machines/two-mirror.yaml
name: two-mirror
cameras: {{spot: {{calibration: spot.camera.yaml}}, kerf: {{calibration: kerf.camera.yaml}}}}
"""
REST = f"""extends: {FIXTURES}/scenarios/native/button.yaml
name: rest
twin: fast
select: {{entities: "1-2,5,8-9"}}
print: {{marks: {marks((-52, -27), (-52, 27), (2, -27), (2, 27), (-15, 27))}}}
"""
SHEETS = {"pictures": "", "pictures-other": "seed: 2\n", "pictures-bad": "planner: {faults: {no_pincushion: true}}\n"}
TILES = "cameras: {kerf: {source: tiles, folder: pictures}}\n"


class Broken(Exception):
    pass


class Outcome:
    """What the bench says of evidence: a verdict, or why it is refused."""

    def __init__(self, word, failing=(), because="", digests=(), but=""):
        self.word, self.failing, self.because, self.digests, self.but = word, failing, because, digests, but

    @classmethod
    def of(cls, results):
        with open(os.path.join(results, "latest", "verdict.json"), encoding="utf-8") as file:
            verdict = json.load(file)
        invalid = [check["explanation"] for check in verdict["checks"] if check["verdict"] == "INVALID"]
        return cls(verdict["verdict"], [c["name"] for c in verdict["checks"] if c["verdict"] == "FAIL"],
                   (verdict["problems"] + invalid + [""])[0], (verdict["digest"], verdict["inputs_digest"]),
                   "; ".join(r["text"] for r in verdict["reservations"] if r["kind"] != "part_not_judged"))


class Row:
    """One edit, tried in one case, in one or more forms."""

    def __init__(self, edit, kind, case, outcomes, base):
        self.edit, self.kind, self.case, self.outcomes, self.base = edit, kind, case, outcomes, base

    def name(self):
        return f"{self.edit.name} ({self.case})"

    def said(self):
        return f"{self.name()}: " + ("nothing to edit" if not self.outcomes else ", ".join(
            f"{form} {outcome.word}" for form, outcome in self.outcomes.items()))

    def complaints(self):
        found = [(form, self._wrong(form, outcome)) for form, outcome in self.outcomes.items()]
        return [f"{self.name()}, {form}: {wrong}" for form, wrong in found if wrong]

    def _wrong(self, form, outcome):
        if outcome.word == "untouched":
            return ""
        if outcome.word == "refused":
            return "" if re.search(r"\.(vcd|yaml|png|json|txt|dxf)\b", outcome.because) else f"no file is named: {outcome.because}"
        if outcome.word != "PASS":
            return ""
        if outcome.digests == self.base:
            return "" if self.edit.unread else "PASS with the same digests"
        if form == "foreign" and not outcome.but:
            return "PASS, and nothing says what was not judged"
        return "" if self.edit.reason(self.case) else "PASS"


class ResultRow(Row):
    """An edit of a results folder: found, refused, or taken for what a run wrote."""

    def _wrong(self, form, outcome):
        if outcome.word in ("differs", "refused"):
            return ""
        return "" if self.edit.by_sums_alone and form != "edited" else "taken for what a run wrote"


class Bench:
    FORMS = ("edited", "summed", "foreign")

    def __init__(self, programs, folder):
        self.programs, self.folder = programs, folder
        self.base, self.recordings = {}, {}

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def call(self, program, *arguments, good=(0,)):
        done = subprocess.run([os.path.join(self.programs, program), *arguments], capture_output=True, text=True, cwd=self.folder,
                              check=False)
        if done.returncode not in good:
            raise Broken(f"{program} {' '.join(arguments)}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
        return done

    def judge(self, *arguments, folder):
        """Runs or replays a scenario whose results go to a folder."""
        return self.call("kerfbench", *arguments, "--no-pictures", "-q", "--jobs", "1", "--results-dir", folder,
                         good=VERDICTS + (REFUSED,))

    # --- The good cases

    def prepare(self, pictures, rest):
        self._case("moving", {"scenario.yaml": MOVING, "machine.yaml": MOVING_MACHINE}, {
            "drawing.dxf": "dielines/label-60x40.dxf", "other.dxf": "dielines/button.dxf",
            "spot.camera.yaml": "machines/two-mirror.spot.camera.yaml",
            "kerf.camera.yaml": "machines/two-mirror.kerf.camera.yaml",
            "other.kerf.camera.yaml": "machines/two-mirror-300.kerf.camera.yaml"})
        if rest or pictures:
            self._case("rest", {"scenario.yaml": REST}, {})
        if pictures:
            self._photograph()

    def _case(self, name, texts, copies):
        os.makedirs(self.path(name))
        for file, text in texts.items():
            write(self.path(name, file), text)
        for file, fixture in copies.items():
            shutil.copy(os.path.join(FIXTURES, fixture), self.path(name, file))
        self.judge("run", self.path(name, "scenario.yaml"), folder=self.path("good"))
        good = Outcome.of(self.path("good", name))
        again = self.replayed(self.path("good", name, "latest", "pins.vcd"), self.path(name))
        if (good.word, again.word, again.digests) != ("PASS", "PASS", good.digests):
            raise Broken(f"{name}: the good run is {good.word}, its replay {again.word}, digests {good.digests}, {again.digests}")
        self.base[name] = good.digests
        with open(self.path("good", name, "latest", "pins.vcd"), encoding="utf-8") as file:
            self.recordings[name] = Recording(file.read())
        shutil.copy(self.path("good", name, "latest", "pins.vcd"), self.path(name, "pins.vcd"))

    def _photograph(self):
        """Pictures of the sheet at rest, of another good one and of a bad one; from here on the case has the first."""
        folder = self.path("photographed")
        shutil.copytree(self.path("rest"), folder)
        for name, more in SHEETS.items():
            write(os.path.join(folder, "scenario.yaml"), REST + more)
            self.call("kerfbench-photograph", os.path.join(folder, "scenario.yaml"), os.path.join(folder, name))
        write(os.path.join(folder, "scenario.yaml"), REST + TILES)
        good = self.replayed(os.path.join(folder, "pins.vcd"), folder)
        if good.word != "PASS":
            raise Broken(f"photographed: {good.word} {good.because} {good.failing}")
        self.base["photographed"] = good.digests

    # --- Judged again

    def replayed(self, pins, case):
        """The outcome of pins with the scenario of a case's folder."""
        with tempfile.TemporaryDirectory(dir=self.folder) as results:
            done = self.judge("replay", pins, "--scenario", os.path.join(case, "scenario.yaml"), folder=results)
            if done.returncode == REFUSED:
                return self.refused(done)
            outcome = Outcome.of(os.path.join(results, os.listdir(results)[0]))
            outcome.because = self.without_folders(outcome.because)
            return outcome

    def refused(self, done):
        return Outcome("refused", because=self.without_folders(done.stderr.strip().splitlines()[0]))

    def without_folders(self, text):
        """A sentence as it is in every run: without the folders of this one."""
        return re.sub(rf"{re.escape(self.folder)}/(tmp\w+/)?", "", text)

    def pins_edited(self, edit, case, forms):
        recording = self.recordings[case].copy()
        try:
            edit.apply(recording)
        except pin_edits.NothingToEdit:
            return Row(edit, edit.kind, case, {}, self.base[case])
        outcomes = {}
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            pins = os.path.join(folder, "pins.vcd")
            for form in forms:
                text = getattr(recording, form)()
                if form == "foreign" and text == self.recordings[case].foreign():
                    outcomes[form] = Outcome("untouched")
                    continue
                write(pins, text)
                outcomes[form] = self.replayed(pins, self.path(case))
        return Row(edit, edit.kind, case, outcomes, self.base[case])

    def files_edited(self, edit):
        case = edit.case
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            copy = os.path.join(folder, case)
            shutil.copytree(self.path(case), copy)
            edit.apply(copy)
            outcome = self.replayed(os.path.join(copy, "pins.vcd"), copy)
        return Row(edit, edit.kind, case, {"edited": outcome}, self.base[case])

    def results_edited(self, edit):
        outcomes = {}
        for form in ("edited", "listed anew"):
            with tempfile.TemporaryDirectory(dir=self.folder) as folder:
                copy = os.path.join(folder, "moving")
                shutil.copytree(self.path("good", "moving", "latest"), copy)
                edit.apply(copy)
                if form == "listed anew":
                    if not os.path.exists(os.path.join(copy, result_edits.LIST)):
                        continue
                    result_edits.list_anew(copy)
                outcomes[form] = self.verified(copy, again=form != "edited")
        return ResultRow(edit, "results", "moving", outcomes, self.base["moving"])

    def verified(self, results, again):
        """Asks about results: by their sums alone, or with the digest that was kept and the pins judged again."""
        more = ("--scenario", self.path("moving", "scenario.yaml"), "--digest", self.base["moving"][0]) if again else ()
        done = self.call("kerfbench", "verify", results, "-q", "--jobs", "1", *more, good=(0, 1, REFUSED))
        if done.returncode == REFUSED:
            return self.refused(done)
        lines = [line.strip() for line in done.stdout.splitlines() if line.startswith("  ")]
        return Outcome("differs" if done.returncode else "as written", because="; ".join(lines))


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
