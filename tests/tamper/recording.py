# SPDX-License-Identifier: Apache-2.0
"""A pins.vcd of the bench as edges and words that can be edited, and the three forms in which it is handed in again.

Stamps are those of the file, in units of its time scale; ticks are the recording's own.
"""
import copy
import hashlib
import re

SUM = "$comment kerfbench sum "
OWN = "$comment kerfbench "


class Edge:
    """A change of a wire."""
    __slots__ = ("stamp", "wire", "level")

    def __init__(self, stamp, wire, level):
        self.stamp, self.wire, self.level = stamp, wire, level


class Recording:
    """Header lines, wires, edges by stamp, the last stamp, what the controller said (pairs of tick and hex
    digits), and what stands behind the sum in its line, which is nothing."""

    def __init__(self, text):
        header, rest = text.split("$enddefinitions $end\n", 1)
        self.header = header.splitlines()
        self.ids = {name: id for id, name in re.findall(r"\$var wire 1 (\S+) (\S+) \$end", header)}
        names = {id: name for name, id in self.ids.items()}
        self.rest, rest = rest.split("$end\n", 1)       # The levels at the start.
        self.edges, self.words, self.sum, stamp = [], [], "", 0
        for line in rest.splitlines():
            if line[0] == "#":
                stamp = int(line[1:])
            elif line[0] in "01":
                self.edges.append(Edge(stamp, names[line[1:]], line[0]))
            elif line.startswith(OWN + "uart "):
                self.words.append((int(line.split()[3]), line.split()[4]))
            elif line.startswith(SUM):
                self.sum = line
        self.last, self.behind = stamp, ""
        tick = next(line for line in self.header if line.startswith(OWN + "tick ")).split()[3].split("/")
        self.units_per_tick = self.units_per_s() * int(tick[0]) // int(tick[1])

    def copy(self):
        """One that can be edited without changing this one."""
        other = copy.copy(self)
        other.header, other.words, other.ids = list(self.header), list(self.words), dict(self.ids)
        other.edges = [Edge(edge.stamp, edge.wire, edge.level) for edge in self.edges]
        return other

    def units_per_s(self):
        number, unit = next(line for line in self.header if line.startswith("$timescale")).split()[1:3]
        return round({"s": 1, "ms": 1e3, "us": 1e6, "ns": 1e9, "ps": 1e12, "fs": 1e15}[unit] / int(number))

    def units(self, seconds):
        """A time as a whole number of ticks, in stamps."""
        return round(seconds * self.units_per_s() / self.units_per_tick) * self.units_per_tick

    def of(self, *wires):
        return [edge for edge in self.edges if edge.wire in wires]

    def span(self, *wires):
        """First and last stamp of some wires."""
        stamps = [edge.stamp for edge in self.of(*wires)]
        return stamps[0], stamps[-1]

    def mend(self):
        """Takes away changes to the level that a wire has, as a careful forger does at the seam of a cut."""
        levels, kept = dict.fromkeys(self.ids, "0"), []
        for edge in self.edges:
            if levels[edge.wire] != edge.level:
                levels[edge.wire] = edge.level
                kept.append(edge)
        self.edges = kept

    def set_comment(self, word, value):
        """Replaces or adds a comment of the header; None takes it away."""
        begin = OWN + word + " "
        kept = [line for line in self.header if not line.startswith(begin)]
        self.header = kept if value is None else kept[:1] + [f"{begin}{value} $end"] + kept[1:]

    def recount(self):
        """The number of words in the header is that of the words below, as a careful forger leaves it."""
        self.set_comment("words", len(self.words) if self.words else None)

    def _body(self, own):
        lines, stamp = [], 0
        for edge in self.edges:
            if edge.stamp != stamp:
                stamp = edge.stamp
                lines.append(f"#{stamp}")
            lines.append(edge.level + self.ids[edge.wire])
        if self.last != stamp:
            lines.append(f"#{self.last}")
        if own:
            lines += [f"{OWN}uart {tick} {digits} $end" for tick, digits in self.words]
        return "\n".join(lines) + "\n"

    def _text(self, header, own):
        return "\n".join(header) + "\n$enddefinitions $end\n" + self.rest + "$end\n" + self._body(own)

    def edited(self):
        """With the sum that the file had before the edit."""
        return self._text(self.header, True) + self.sum + self.behind + "\n"

    def summed(self):
        """With a sum of its own, as anybody can write it."""
        text = self._text(self.header, True)
        return text + SUM + hashlib.sha256(text.encode()).hexdigest() + f" $end{self.behind}\n"

    def foreign(self):
        """As a program that knows nothing of the bench would have written it: no comment of ours, no word."""
        return self._text([line for line in self.header if not line.startswith(OWN)], False)
