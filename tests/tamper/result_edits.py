# SPDX-License-Identifier: Apache-2.0
"""Ways to tamper with a results folder after the verdict. `kerfbench verify` has to find them.

Each edit is tried as it is, with the sums of the folder alone; and with the sums of its list written anew, with the digest that was
kept elsewhere and the pins judged again. `by_sums_alone` says why an edit is found only while the list is as the run wrote it.
"""
import hashlib
import json
import os
import re

from recording import Recording

LIST = "kerfbench-results.txt"
EDITS = []


class ResultEdit:
    def __init__(self, name, what, apply, by_sums_alone, quick):
        self.name, self.what, self.apply, self.by_sums_alone, self.quick = name, what, apply, by_sums_alone, quick


def edit(what, by_sums_alone="", quick=False):
    def note(apply):
        EDITS.append(ResultEdit(apply.__name__.replace("_", "-"), what, apply, by_sums_alone, quick))
        return apply
    return note


def path(folder, name):
    return os.path.join(folder, name)


def read(folder, name):
    with open(path(folder, name), encoding="utf-8") as file:
        return file.read()


def write(folder, name, text):
    with open(path(folder, name), "w", encoding="utf-8") as file:
        file.write(text)


def list_anew(folder):
    """Writes the sums of all files anew, as anybody can."""
    lines = read(folder, LIST).splitlines()[:1]
    for name in sorted(os.listdir(folder)):
        if name != LIST:
            with open(path(folder, name), "rb") as file:
                lines.append(f"{hashlib.sha256(file.read()).hexdigest()}  {name}")
    write(folder, LIST, "\n".join(lines) + "\n")


def verdict(folder, change):
    content = json.loads(read(folder, "verdict.json"))
    change(content)
    write(folder, "verdict.json", json.dumps(content, indent=2, ensure_ascii=False) + "\n")


@edit("a value of a check in verdict.json")
def check_value(folder):
    def change(content):
        content["checks"][0]["value"] /= 2
    verdict(folder, change)


@edit("a check taken out of verdict.json")
def check_out(folder):
    verdict(folder, lambda content: content["checks"].pop())


@edit("a limit in verdict.json")
def check_limit(folder):
    def change(content):
        content["checks"][0]["limit"] *= 0.5
    verdict(folder, change)


@edit("the verdict in verdict.json")
def verdict_word(folder):
    verdict(folder, lambda content: content.update(verdict="FAIL", exit_code=1))


@edit("the seed in verdict.json")
def verdict_seed(folder):
    verdict(folder, lambda content: content.update(seed=7))


@edit("the digest in verdict.json")
def verdict_digest(folder):
    verdict(folder, lambda content: content.update(digest="0" * 64))


@edit("the digest of the inputs in verdict.json")
def verdict_inputs_digest(folder):
    verdict(folder, lambda content: content.update(inputs_digest="0" * 64))


@edit("a reservation written into verdict.json")
def reservation_added(folder):
    verdict(folder, lambda content: content["reservations"].append({"kind": "not_judged", "text": "nothing"}))


@edit("the firmware's name in verdict.json",
      by_sums_alone="Pins do not tell which image made them: of a release's name there is nothing but the bench's word.")
def firmware_name(folder):
    verdict(folder, lambda content: content.update(firmware="another-release.hex (AVR emulator)"))


@edit("verdict.json is no JSON")
def verdict_broken(folder):
    write(folder, "verdict.json", read(folder, "verdict.json")[:1000])


@edit("a failure taken out of junit.xml, or one written into it")
def junit_failure(folder):
    text = read(folder, "junit.xml")
    write(folder, "junit.xml", text.replace('failures="0"', 'failures="1"', 1))


def pins(folder, change, sums):
    recording = Recording(read(folder, "pins.vcd"))
    change(recording)
    text = recording.summed() if sums else recording.edited()
    write(folder, "pins.vcd", text)
    return text


def drop_pulse(recording):
    edges = recording.of("galvo_x_pul")
    gone = {id(edge) for edge in edges[1000:1002]}
    recording.edges = [edge for edge in recording.edges if id(edge) not in gone]


@edit("a pulse out of pins.vcd")
def pins_pulse_out(folder):
    pins(folder, drop_pulse, sums=False)


@edit("a pulse out of pins.vcd, its sum written anew", quick=True)
def pins_pulse_out_summed(folder):
    pins(folder, drop_pulse, sums=True)


@edit("a pulse out of pins.vcd, its sum written anew there and in verdict.json")
def pins_pulse_out_everywhere(folder):
    text = pins(folder, drop_pulse, sums=True)
    sum_of_pins = text.rsplit(" ", 2)[1]
    verdict(folder, lambda content: content["evidence"][0].update(sha256=sum_of_pins))


@edit("the words of the controller out of pins.vcd, its sum written anew there and in verdict.json")
def pins_words_out(folder):
    def change(recording):
        recording.words = []
        recording.recount()
    text = pins(folder, change, sums=True)
    verdict(folder, lambda content: content["evidence"][0].update(sha256=text.rsplit(" ", 2)[1]))


@edit("a comment in scenario.yaml")
def scenario_changed(folder):
    write(folder, "scenario.yaml", read(folder, "scenario.yaml") + "# nothing\n")


@edit("a word in report.html",
      by_sums_alone="The page has times of the host and pictures, so that it cannot be made again byte by byte.")
def report_word(folder):
    write(folder, "report.html", read(folder, "report.html").replace("PASS", "pass", 1))


@edit("a line of job.gcode",
      by_sums_alone="The G-code is kept for people; the verdict rests on pins and pictures.")
def gcode_line(folder):
    write(folder, "job.gcode", re.sub(r"X(-?)([0-9])", r"X\g<1>9", read(folder, "job.gcode"), count=1))


@edit("pins.vcd deleted")
def pins_out(folder):
    os.remove(path(folder, "pins.vcd"))


@edit("report.html deleted",
      by_sums_alone="A page that is neither there nor listed is not missed.")
def report_out(folder):
    os.remove(path(folder, "report.html"))


@edit("a file added",
      by_sums_alone="A file that is listed is taken for one of the run's; nothing else names it.")
def file_added(folder):
    write(folder, "notes.txt", "somebody's\n")


@edit("the list deleted")
def list_out(folder):
    os.remove(path(folder, LIST))
