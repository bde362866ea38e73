#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws where the processor's time of a run goes, as a flame graph: perf samples the call stacks, a box is as wide as the share of
samples in which a function, or what it calls, was at work.

Needs perf (apt-get install linux-perf) and the right to use it. Exit code: 0 done, 2 something broke, 64 usage.
"""
import argparse
import html
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SAMPLES_PER_S = "299"
LEAST_SHARE = 0.004
WIDTH, ROW = 1200, 17
# Nobody asks how the work came to a thread.
PLUMBING = re.compile(r"^(\[unknown\]|_start|__libc_start.*|start_thread|clone3?|__clone3?|execute_native_thread.*|std::|0x|_dl_|__invoke)")
COLOURS = ("#f4b183", "#f7cf8f", "#f2a27a", "#eec07b", "#f6bd9d")


def short(name):
    """A function without namespaces that all have, and without its arguments."""
    name = re.sub(r"kerfbench::|\(anonymous namespace\)::", "", name)
    depth, kept = 0, []
    for part in re.split(r"([<>])", name):
        if part == "<":
            depth += 1
        elif part == ">":
            depth -= 1
        elif depth == 0:
            kept.append(part)
    return "".join(kept).split("(")[0] or name


def stacks_of(script):
    """Stacks of a text by `perf script -F comm,ip,sym`, each from the program down to the function at work."""
    stacks = []
    for block in script.split("\n\n"):
        lines = block.strip("\n").split("\n")
        if not lines or not lines[0].strip():
            continue
        frames = []
        for line in lines[1:]:
            address, _, name = line.strip().partition(" ")
            if address.startswith("ffffffff"):
                name = "" if address == "f" * 16 else "the kernel"  # The former ends a stack.
            if name and not PLUMBING.match(name):
                frames.append(short(name))
        frames = [frame for i, frame in enumerate(frames) if i == 0 or frame != frames[i - 1]]
        stacks.append([lines[0].strip(), *reversed(frames)])
    return stacks


def tree_of(stacks):
    """Counts by function, nested: {name: [count, {...}]}."""
    root = {}
    for stack in stacks:
        level = root
        for name in stack:
            node = level.setdefault(name, [0, {}])
            node[0] += 1
            level = node[1]
    return root


def boxes_of(tree, total, x=0.0, depth=0):
    """(x, depth, share, name) of all boxes that are wide enough to see, the widest first at each level."""
    boxes = []
    for name, (count, below) in sorted(tree.items(), key=lambda item: (-item[1][0], item[0])):
        share = count / total
        if share >= LEAST_SHARE:
            boxes.append((x, depth, share, name))
            boxes += boxes_of(below, total, x, depth + 1)
        x += share
    return boxes


def svg_of(stacks, title):
    boxes = boxes_of(tree_of(stacks), max(1, len(stacks)))
    rows = 1 + max((depth for _, depth, _, _ in boxes), default=0)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{rows * ROW + 30}" '
           f'viewBox="0 0 {WIDTH} {rows * ROW + 30}" font-family="sans-serif" font-size="11">',
           '<rect width="100%" height="100%" fill="#fff"/>', f'<text x="4" y="18" font-size="13">{html.escape(title)}</text>']
    for x, depth, share, name in boxes:
        left, top, width = WIDTH * x, 26 + ROW * depth, WIDTH * share
        letters = int((width - 6) / 6.2)
        shown = name if len(name) <= letters else name.split("::")[-1]
        text = shown if len(shown) <= letters else shown[:letters - 1] + "…" if letters > 4 else ""
        out.append(f'<g><title>{html.escape(name)}: {100 * share:.1f} %</title><rect x="{left:.1f}" y="{top}" width="{width:.1f}" '
                   f'height="{ROW - 1}" fill="{COLOURS[sum(map(ord, name)) % len(COLOURS)]}" stroke="#fff" stroke-width="0.5"/>'
                   + (f'<text x="{left + 3:.1f}" y="{top + 12}">{html.escape(text)}</text>' if text else "") + "</g>")
    return "\n".join([*out, "</svg>", ""])


def sampled(command):
    """What perf's samples of a command's stacks say, as text."""
    with tempfile.TemporaryDirectory(prefix="kerfbench-perf-") as folder:
        data = os.path.join(folder, "perf.data")
        ran = subprocess.run(["perf", "record", "-q", "-o", data, "-F", SAMPLES_PER_S, "--call-graph", "dwarf,32768", "--", *command],
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if not os.path.exists(data) or ran.returncode not in (0, 1):
            raise RuntimeError(f"{' '.join(command)} under perf: exit code {ran.returncode}\n{ran.stdout}")
        script = subprocess.run(["perf", "script", "-i", data, "--no-inline", "-F", "comm,ip,sym"],
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True)
        return script.stdout


def main():
    parser = argparse.ArgumentParser(prog="bench benchmark flame", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", nargs="?", default=os.path.join(ROOT, "fixtures", "scenarios", "label-on-belt.yaml"))
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="FOLDER")
    parser.add_argument("--out", default="flame.svg", metavar="FILE", help="default flame.svg")
    try:
        args = parser.parse_args()
    except SystemExit as end:
        return 64 if end.code else 0
    try:
        with tempfile.TemporaryDirectory(prefix="kerfbench-flame-") as folder:
            stacks = stacks_of(sampled([os.path.join(args.build, "bin", "kerfbench"), "run", args.scenario, "--twin", "fast",
                                        "--no-pictures", "--results-dir", folder]))
        name = os.path.splitext(os.path.basename(args.scenario))[0]
        with open(args.out, "w", encoding="utf-8") as file:
            file.write(svg_of(stacks, f"{name}: {len(stacks)} samples of the processor"))
    except FileNotFoundError as error:
        print(f"flame: {error.filename} is not there (perf: apt-get install linux-perf)", file=sys.stderr)
        return 2
    except (OSError, RuntimeError, subprocess.CalledProcessError) as error:
        print(f"flame: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
