# SPDX-License-Identifier: Apache-2.0
"""Are lines about figures written as figures_test.cpp reads them, with the same digest, and aged by their sources alone?"""
import os
import re
import subprocess
import tempfile
import unittest

import stamp

# The same files and the same digest are in figures_test.cpp.
FILES = {"a/one.cpp": "int one;\n", "a/b/two.h": "int two;\n", "a/b.py": "three = 3\n", "a/notes.md": "no source\n",
         "list.toml": "four = 4\n", "ab/five.c": "int five;\n"}
DIGEST = "92bb1ad0b846"


class Tree(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="kerfbench-figures-")
        self.addCleanup(folder.cleanup)
        self.root = folder.name
        for name, text in FILES.items():
            self.put(name, text)

    def path(self, name):
        return os.path.join(self.root, name)

    def put(self, name, text):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def commit(self):
        for words in (["init", "-q"], ["add", "."], ["-c", "user.name=x", "-c", "user.email=x", "commit", "-q", "-m", "x"]):
            subprocess.run(["git", "-C", self.root, *words], check=True)


class Digest(Tree):
    def test_is_the_one_of_the_other_program(self):
        self.assertEqual(stamp.digest_now("a list.toml", self.root), DIGEST)

    def test_changes_with_sources_alone(self):
        self.put("a/notes.md", "other words\n")
        self.put("ab/five.c", "int other;\n")
        self.assertEqual(stamp.digest_now("a list.toml", self.root), DIGEST)
        self.put("list.toml", "four = 5\n")
        self.assertNotEqual(stamp.digest_now("a list.toml", self.root), DIGEST)

    def test_needs_its_sources(self):
        self.assertRaises(FileNotFoundError, stamp.digest_now, "a none", self.root)

    def test_of_a_commit_is_that_of_its_tree(self):
        self.commit()
        self.put("a/one.cpp", "int other;\n")
        self.assertEqual(stamp.digest_at("HEAD", "a list.toml", self.root), DIGEST)
        self.assertIsNone(stamp.digest_at("HEAD", "a none", self.root))


class Line(Tree):
    def setUp(self):
        super().setUp()
        pages = stamp.PAGES
        self.addCleanup(setattr, stamp, "PAGES", pages)
        stamp.PAGES = {"page": stamp.Page("PAGE.md", "./bench page", "a list.toml")}

    def line(self, *more):
        return stamp.line_of("page", "seed 1", *more, root=self.root)

    def test_says_all(self):
        self.commit()
        self.assertTrue(stamp.STAMP.fullmatch(self.line()))
        self.assertRegex(self.line("./bench page --sample 3"), re.escape(
            f"seed 1, by `./bench page --sample 3`; of sources `a list.toml`, {DIGEST}.*") + "$")
        self.assertNotIn("changes", self.line())
        self.assertEqual(self.line(), self.line())

    def test_tells_of_changes_to_its_sources_alone(self):
        self.commit()
        self.put("ab/five.c", "int other;\n")
        self.assertNotIn("changes", self.line())
        self.put("a/new.h", "int other;\n")
        self.assertIn(" and changes to it, seed 1", self.line())
        self.assertTrue(stamp.STAMP.fullmatch(self.line()))

    def test_without_history_is_none(self):
        self.assertIsNone(stamp.STAMP.search(self.line()))

    def test_ages_and_is_young_again(self):
        self.commit()
        text = f"before\n{self.line()}\nafter\n"
        self.assertEqual(stamp.aged(text, self.root), text)
        self.put("a/one.cpp", "int other;\n")
        old = stamp.aged(text, self.root)
        self.assertEqual(old, text.replace(".*", "; older than their sources.*"))
        self.assertEqual(stamp.aged(old, self.root), old)
        self.put("a/one.cpp", FILES["a/one.cpp"])
        self.assertEqual(stamp.aged(old, self.root), text)

    def test_of_rows_that_are_kept_is_theirs(self):
        self.commit()
        first = self.line()
        self.put("PAGE.md", first + "\n")
        page = self.path("PAGE.md")
        self.assertEqual(stamp.line_with_rows_kept(self.line("./bench other"), page, self.root), self.line("./bench other"))
        self.put("a/one.cpp", "int other;\n")
        self.assertEqual(stamp.line_with_rows_kept(self.line(), page, self.root),
                         first.replace(".*", "; older than their sources.*"))


class Pages(unittest.TestCase):
    def test_have_the_line_of_their_command(self):
        for name, (path, command, sources) in stamp.PAGES.items():
            found = [line for line in stamp.STAMP.finditer(stamp.read(os.path.join(stamp.ROOT, path)))
                     if line["sources"] == sources]
            self.assertEqual(len(found), 1, name)
            self.assertIn(f"by `{command}", found[0][0])


if __name__ == "__main__":
    unittest.main()
