# SPDX-License-Identifier: Apache-2.0
"""A recording of pins (pins.vcd), to edit into what a release with a fault would have sent.

A written recording carries its own SHA-256, so the bench takes it for what the controller sent; as one of another
program it has neither digest nor the controller's words: docs/reference/formats.md.
"""
import bisect
import hashlib
import re


class Recording:
    """Edges of each wire and the words of the controller, by their tick."""

    def __init__(self, path):
        with open(path, encoding="ascii") as file:
            text = file.read()
        header, body = text.split("$enddefinitions $end\n")
        again = re.compile(r"\$comment kerfbench (end|sum|words) ")  # Written anew.
        self.header = [line for line in header.splitlines() if not again.match(line)]
        numerator, denominator = map(int, re.search(r"kerfbench tick (\d+)/(\d+)", header).groups())
        self.tick_s = numerator / denominator
        unit = re.search(r"\$timescale (\d+) (ns|ps|fs) \$end", header)
        unit_s = int(unit.group(1)) * {"ns": 1e-9, "ps": 1e-12, "fs": 1e-15}[unit.group(2)]
        self.stamps_per_tick = round(self.tick_s / unit_s)
        self.end = int(re.search(r"kerfbench end (\d+)", header).group(1))
        self.names = dict(re.findall(r"\$var wire 1 (\S) (\w+) \$end", header))
        self.wires = {name: [] for name in self.names.values()}
        self.words = [(int(t), w) for t, w in re.findall(r"\$comment kerfbench uart (\d+) ([0-9a-f]+) \$end", body)]
        tick = 0
        for line in body[body.index("$end\n") + 5:].splitlines():
            if line[0] == "#":
                tick, rest = divmod(int(line[1:]), self.stamps_per_tick)
                assert rest == 0, "a stamp between two ticks"
            elif line[0] in "01":
                self.wires[self.names[line[1]]].append((tick, int(line[0])))

    def write(self, path, own=True):
        identifiers = {name: identifier for identifier, name in self.names.items()}
        # The machine's outputs before the sensors, as the order of the wires has them.
        edges = sorted(((tick, order, level, identifiers[name]) for order, name in enumerate(self.wires)
                        for tick, level in self.wires[name]), key=lambda edge: edge[:2])
        lines = [line for line in self.header if own or not line.startswith("$comment kerfbench")]
        if own:
            lines[2:2] = [f"$comment kerfbench end {self.end} $end", "$comment kerfbench sum sha256 $end"]
            lines[4:4] = [f"$comment kerfbench words {len(self.words)} $end"] if self.words else []
        text = "\n".join(lines) + "\n$enddefinitions $end\n#0\n$dumpvars\n"
        text += "".join(f"0{identifier}\n" for identifier in self.names) + "$end\n"
        parts, last = [], 0
        for tick, _, level, identifier in edges:
            if tick != last:
                parts.append(f"#{tick * self.stamps_per_tick}\n")
                last = tick
            parts.append(f"{level}{identifier}\n")
        text += "".join(parts) + f"#{max(self.end, last + 1) * self.stamps_per_tick}\n"
        if own:
            text += "".join(f"$comment kerfbench uart {tick} {word} $end\n" for tick, word in self.words)
            text += f"$comment kerfbench sum {hashlib.sha256(text.encode('ascii')).hexdigest()} $end\n"
        with open(path, "w", encoding="ascii") as file:
            file.write(text)

    def ticks(self, seconds):
        return round(seconds / self.tick_s)

    def edges(self, wire, level):
        """Ticks at which the wire takes this level."""
        return [tick for tick, to in self.wires[wire] if to == level]

    def spans(self, wire):
        """Stretches for which the wire is high."""
        rises, falls = self.edges(wire, 1), self.edges(wire, 0)
        return list(zip(rises, falls + [self.end] * (len(rises) - len(falls))))

    def level(self, wire, tick):
        """Level at a tick, its own edge included."""
        at = bisect.bisect_right(self.wires[wire], (tick, 1))
        return self.wires[wire][at - 1][1] if at else 0
