# SPDX-License-Identifier: Apache-2.0
"""Has kerfbench read a large drawing on a terminal: does it tell how far it is, and leave nothing of that behind? And into a
file: is nothing of it there? Usage: terminal_progress.py KERFBENCH"""
import os
import pathlib
import pty
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
LINES = "100000"
ERASE = "\r\x1b[K"


def on_a_terminal(command):
    """Exit code and all that a terminal is sent."""
    master, terminal = pty.openpty()
    with subprocess.Popen(command, stdin=terminal, stdout=terminal, stderr=terminal) as program:
        os.close(terminal)
        said = b""
        while True:
            try:
                part = os.read(master, 65536)
            except OSError:  # Its other end is closed.
                break
            if not part:
                break
            said += part
    os.close(master)
    return program.returncode, said.decode()


def main(kerfbench):
    with tempfile.TemporaryDirectory() as folder:
        drawing = os.path.join(folder, "many.dxf")
        subprocess.run([sys.executable, "-B", HERE / "large_drawing.py", "squares", LINES, drawing], check=True)
        command = [kerfbench, "lint", drawing]
        code, said = on_a_terminal(command)
        assert code == 0, said[-500:]
        for word in ("reading", "checking"):
            shares = [int(share) for share in re.findall(rf"{re.escape(ERASE)}  {word} many\.dxf, (\d+) %", said)]
            assert len(shares) >= 3, f"{word}: {shares}"
            assert shares == sorted(set(shares)) and shares[-1] < 100, f"{word}: {shares}"
        shown = said.replace("\r\n", "\n").split(ERASE)[-1]
        into_a_file = subprocess.run(command, capture_output=True, text=True, check=True)
        assert "\r" not in into_a_file.stdout + into_a_file.stderr, into_a_file
        assert shown == into_a_file.stdout + into_a_file.stderr, f"{shown!r} is not {into_a_file!r}"


if __name__ == "__main__":
    main(sys.argv[1])
