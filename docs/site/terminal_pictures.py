#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""terminal_pictures.py BIN SOURCE OUT: photographs of a terminal for the documents: help, progress, a mistyped word and a completion. Each program
runs on a terminal of its own (a pty); what it writes there is shown as the terminal would show it, and photographed by Chromium.

./bench terminal-pictures writes docs/terminal-*.png."""
import codecs
import html
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time

COLUMNS, ROWS = 100, 24
PATIENCE_S = 300
CONTROL = re.compile(r"\x1b\[([0-9;?]*)([A-Za-z])|\x1b\][^\x07]*\x07|\x1b[=>()][0-9A-B]?")
COLOURS = {31: "#c4314b", 32: "#1d7a3a", 33: "#9a6a00", 34: "#2457b8", 35: "#8a3fa0", 36: "#0f7b85", 90: "#6b7280"}


class Screen:
    """Text and its look, as far as the programs and bash use a terminal."""

    def __init__(self):
        self.rows, self.column, self.look = [[]], 0, ()

    def put(self, text):
        at = 0
        while at < len(text):
            found = CONTROL.match(text, at)
            if found:
                self.control(found[1] or "", found[2] or "")
                at = found.end()
                continue
            self.character(text[at])
            at += 1

    def character(self, c):
        if c == "\r":
            self.column = 0
        elif c == "\n":
            self.rows.append([])
            self.column = 0
        elif c == "\b":
            self.column = max(0, self.column - 1)
        elif c >= " ":
            row = self.rows[-1]
            row.extend([(" ", ())] * (self.column - len(row)))
            row[self.column:self.column + 1] = [(c, self.look)]
            self.column += 1

    def control(self, numbers, letter):
        if letter == "K":
            del self.rows[-1][self.column:]
        elif letter == "m":
            for number in (int(n or 0) for n in numbers.split(";")):
                self.look = () if number == 0 else (*self.look, number)
        elif letter == "C":
            self.column += int(numbers or 1)

    def html(self):
        lines = []
        for row in self.rows[-ROWS:] if len(self.rows) > ROWS else self.rows:
            line = ""
            for c, look in row:
                style = "".join("font-weight:700;" if n == 1 else f"color:{COLOURS[n]};" if n in COLOURS else "" for n in look)
                line += f'<span style="{style}">{html.escape(c)}</span>' if style else html.escape(c)
            lines.append(line)
        return "\n".join(lines)

    def text(self):
        return "\n".join("".join(c for c, _ in row) for row in self.rows)


def on_terminal(command, folder, environment, steps, enough=lambda text: False):
    """Runs a command on a terminal. `steps`: (text to wait for, what is typed then). It is ended when `enough` of the screen's text."""
    pid, terminal = pty.fork()
    if pid == 0:
        os.chdir(folder)
        os.execvpe(command[0], command, environment)
    screen, deadline = Screen(), time.monotonic() + PATIENCE_S
    steps = list(steps)
    decoder = codecs.getincrementaldecoder("utf-8")("replace")
    while time.monotonic() < deadline:
        ready = select.select([terminal], [], [], 1.5)[0]
        if ready:
            try:
                piece = os.read(terminal, 4096)
            except OSError:
                break
            screen.put(decoder.decode(piece))
        if steps and steps[0][0] in screen.text():
            os.write(terminal, steps.pop(0)[1].encode())
        if enough(screen.text()):
            break
    try:
        os.kill(pid, signal.SIGTERM)
        os.kill(pid, signal.SIGHUP)
    except ProcessLookupError:
        pass
    os.close(terminal)
    os.waitpid(pid, 0)
    return screen


def is_half_way(text):
    """Whether the last line, which progress overwrites, tells a share of at least a third."""
    shares = re.findall(r"(\d+) ?%", text.split("\n")[-1])
    return bool(shares) and int(shares[-1]) >= 33


def photograph(title, screen, out, work):
    page = work / f"{out.stem}.html"
    rows = min(len(screen.rows), ROWS)
    page.write_text(f"""<!doctype html><meta charset=utf-8><style>body{{margin:0;background:#f6f8fa}}pre{{margin:0;padding:12px 16px;
font:13px/18px 'DejaVu Sans Mono',monospace;color:#1f2328;background:#f6f8fa}}div{{font:12px/24px 'DejaVu Sans',sans-serif;color:#57606a;
background:#e7ebef;padding:0 16px}}</style><div>{html.escape(title)}</div><pre>{screen.html()}</pre>""", encoding="utf-8")
    # The browser counts 90 pixels of its own window as well.
    subprocess.run(["chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={work}/browser",
                    f"--window-size=880,{24 + 24 + 18 * rows + 90}", f"--screenshot={out}", page.as_uri()], check=True, capture_output=True)
    print(f"{out}: {out.stat().st_size / 1000:.1f} kB")


def main():
    bin_dir, source, out = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
    work = pathlib.Path(tempfile.mkdtemp(prefix="terminal-pictures-"))
    try:
        (work / "fixtures").symlink_to(source / "fixtures")
        environment = {"PATH": f"{bin_dir}:/usr/bin:/bin", "HOME": str(work), "TERM": "xterm-256color", "LANG": "C.UTF-8", "COLUMNS": str(COLUMNS),
                       "LINES": str(ROWS), "PS1": "$ "}

        def shell(typed, enough, setup=""):
            (work / "start").write_text(f"PS1='$ '\nstty cols {COLUMNS} rows {ROWS}\n{setup}\n", encoding="utf-8")
            return on_terminal(["bash", "--rcfile", str(work / "start"), "-i"], work, environment, [("$ ", typed)], enough)

        pictures = {
            "terminal-help": ("help", shell("kerfbench history --help\n", lambda t: t.count("$ ") > 1)),
            "terminal-error": ("a mistyped word", shell("kerfbench run fixtures/scenarios/native/button.yaml --twim fast\n", lambda t: t.count("$ ") > 1)),
            "terminal-progress": ("progress", shell("kerfbench run fixtures/scenarios/label-on-belt.yaml --no-pictures\n",
                                                    is_half_way)),
            "terminal-completion": ("completion, after two tabs", shell("kerfbench calibrate \t\t", lambda t: "scanner" in t and t.count("kerfbench calibrate") > 1,
                                                                        "source /usr/share/bash-completion/bash_completion 2>/dev/null\nsource <(kerfbench completion bash)")),
        }
        for name, (title, screen) in pictures.items():
            photograph(title, screen, out / f"{name}.png", work)
    finally:
        shutil.rmtree(work, ignore_errors=True)


if __name__ == "__main__":
    main()
