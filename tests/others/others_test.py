# SPDX-License-Identifier: Apache-2.0
"""Does ./bench drawings tell apart what both readers agree on, what is refused and what they read differently? On a repository
that is made here. Usage: others_test.py KERFBENCH"""
import collections
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
import cartons  # noqa: E402
import others  # noqa: E402
import unpacking  # noqa: E402

KERFBENCH = ""
SVG = '<svg xmlns="http://www.w3.org/2000/svg" {size} viewBox="0 0 50 40">{inside}</svg>\n'
SIZE = 'width="50mm" height="40mm"'
RECTANGLE = '<path fill="none" stroke="#ff0000" d="M5 5 H45 V35 H5 Z"/>'
DRAWINGS = {
    "agree.svg": SVG.format(size=SIZE, inside=RECTANGLE),
    "below/deep/AGREE.SVG": SVG.format(size=SIZE, inside=RECTANGLE),
    "empty.svg": SVG.format(size=SIZE, inside="<text x='5' y='5'>nothing to cut</text>"),
    "px.svg": SVG.format(size='width="50" height="40"', inside=RECTANGLE),
    "left-out.svg": SVG.format(size=SIZE, inside=RECTANGLE),
    "agree.dxf": "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nA\n10\n0\n20\n0\n11\n10\n21\n5\n0\nENDSEC\n0\nEOF\n",
}
Options = collections.namedtuple("Options", "folder program jobs every")


def git(folder, *words):
    subprocess.run(["git", "-C", folder, "-c", "user.name=t", "-c", "user.email=t@t", *words], check=True, capture_output=True)


class Reading(unittest.TestCase):
    def setUp(self):
        self.top = tempfile.TemporaryDirectory()
        self.addCleanup(self.top.cleanup)
        clone = os.path.join(self.top.name, "theirs")
        for name, text in DRAWINGS.items():
            os.makedirs(os.path.dirname(os.path.join(clone, name)), exist_ok=True)
            with open(os.path.join(clone, name), "w", encoding="utf-8") as file:
                file.write(text)
        git(self.top.name, "init", "-q", "theirs")
        git(clone, "add", "-A")
        git(clone, "commit", "-qm", "Drawings")
        self.repository = {"folder": "theirs", "url": "https://example.org/they/theirs", "commit": "HEAD", "kind": "svg",
                           "but": ["left-out.svg"]}

    def read(self, repository):
        reasons = []
        rows, sums = others.read_all(Options(self.top.name, KERFBENCH, 2, 1), [repository], reasons)
        return rows, dict(sums), reasons

    def test_classes(self):
        rows, sums, reasons = self.read(self.repository)
        self.assertEqual(sums, {"agree": 2, "empty": 1, "refused": 1}, reasons)
        self.assertEqual(rows[0], "| they/theirs HEAD (SVG) | 4 | 2 | 1 | 1 | 0 | 0 | 0 |")
        self.assertEqual(len(reasons), 1)
        self.assertIn("theirs/px.svg: refused: FILE:1: svg gives its size in px only", reasons[0])

    def test_dxf_and_folders(self):
        self.assertEqual(self.read({**self.repository, "kind": "dxf", "but": []})[1], {"agree": 1})
        self.assertEqual(self.read({**self.repository, "below": ["below/"]})[1], {"agree": 1})

    def test_missing_repository(self):
        with self.assertRaisesRegex(unpacking.Missing, "nobody is no clone"):
            self.read({**self.repository, "folder": "nobody"})

    def test_missing_commit(self):
        with self.assertRaisesRegex(unpacking.Missing, "theirs, 0123456"):
            self.read({**self.repository, "commit": "0123456"})


class Classes(unittest.TestCase):
    def test_what_lint_says(self):
        part = ("F: error: layer 'A' (cut): this reader finds 2 mm of lines, the second one 1 mm\n"
                "F: error: the second reader (x 1) parts from this one in 1 place; nothing says which is right\n")
        self.assertEqual(others.reading_of(65, part, "").kind, "part")
        self.assertIn("layer 'A'", others.reading_of(65, part, "").why)
        cannot = "F: error: the second reader cannot read the drawing, so that nothing witnesses this reading: why\n"
        self.assertEqual(others.reading_of(65, cannot, "").kind, "no second reading")
        self.assertEqual(others.reading_of(139, "", "").kind, "broken")
        self.assertEqual(others.reading_of(2, "F: error: the second reader hung; it witnesses nothing\n", "").kind, "broken")


class Page(unittest.TestCase):
    def test_marks(self):
        page = f"a\n{others.BEGIN}\nold\n{others.END}\nb\n{others.CUT_BEGIN}\nkept\n{others.END}\nc\n"
        self.assertEqual(others.put_into(page, others.BEGIN, ["new"]), page.replace("old", "new"))
        self.assertEqual(others.put_into(page, others.CUT_BEGIN, ["new"]), page.replace("kept", "new"))
        with self.assertRaises(unpacking.Missing):
            others.put_into("a\n", others.BEGIN, ["new"])


class Spoiling(unittest.TestCase):
    JOB = "LINE\nG00 X10.0000 Y0.0000 Z0 (E1 cut)\nG01 X20.0000 Y0.0000 Z1 (E1 cut)\nG01 X30.0000 Y0.0000 Z0.5 (E2 crease)\n"

    def test_each_changes_what_it_says(self):
        self.assertIn("G01 X20.040000 Y0.000000 Z1 ", cartons.enlarged(self.JOB))
        self.assertEqual(cartons.one_less(self.JOB), self.JOB.replace("G01 X20.0000 Y0.0000 Z1", "G00 X20.0000 Y0.0000 Z0"))
        self.assertEqual(cartons.deep_creases(self.JOB), self.JOB.replace("Z0.5", "Z1"))

    def test_pieces(self):
        text, sides = cartons.ellipse(2.0)
        self.assertEqual(sides, 79)
        self.assertEqual(text.count(" L"), sides - 1)


if __name__ == "__main__":
    KERFBENCH = os.path.abspath(sys.argv.pop(1))
    unittest.main()
