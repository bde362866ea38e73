# SPDX-License-Identifier: Apache-2.0
"""What ./bench papers refuses. Arguments: the folder of the build, the file of rows."""
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
BUILD = sys.argv.pop(1)

GOOD = """
[words]
[[paper]]
name = "S0"
title = "t"
[[paper.row]]
item = "eq. 1"
what = "w"
where = "here"
command = "./bench kerfplan strip-path --pitch 1200 --belt-speed 200 --mark-speed 230 --jump-speed 400 --x-min -20 --x-max 760"
theirs = "304.8"
ours = '1  cut +\\S+ +\\S+ +\\S+ +\\S+ +\\S+ +(\\S+)'
least = 304.7
most = 304.9
chosen = "nothing"
"""


def papers(rows):
    """Runs the rows; the exit code and all that is said."""
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(rows)
        file.flush()
        done = subprocess.run([sys.executable, "-B", os.path.join(HERE, "papers.py"), "--build", BUILD, "--quick", "--rows", file.name],
                              capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


class Papers(unittest.TestCase):
    def test_a_row_that_holds_is_told_with_our_figure(self):
        code, said = papers(GOOD)
        self.assertEqual(code, 0, said)
        self.assertIn("| 304.8 | 304.795 |", said)

    def test_a_figure_out_of_its_bounds_fails(self):
        code, said = papers(GOOD.replace("304.7", "304.8"))
        self.assertEqual(code, 1)
        self.assertIn("S0 eq. 1: 304.795 is out of 304.8 … 304.9", said)

    def test_a_figure_that_is_not_said_fails(self):
        code, said = papers(GOOD.replace("1  cut", "1  cuts"))
        self.assertEqual(code, 1)
        self.assertIn("is not in what", said)

    def test_a_command_that_fails_fails(self):
        code, said = papers(GOOD.replace("--pitch 1200", "--pitch 12"))
        self.assertEqual(code, 1)
        self.assertIn("ends with 65", said)

    def test_a_row_without_a_command_is_refused(self):
        code, said = papers(GOOD.replace("command =", "commands ="))
        self.assertEqual(code, 2)
        self.assertIn("S0 eq. 1: command is missing", said)
        self.assertIn("S0 eq. 1: unknown key commands", said)


if __name__ == "__main__":
    unittest.main()
