# SPDX-License-Identifier: Apache-2.0
"""Builds a test program with one source changed, from what a build folder already has.

The changed file lies in an overlay folder that the compiler searches first. What it compiles to is linked in front of
the libraries, so that the linker never fetches the original from its archive. The source tree and the build folder
are read, never written; one mutant costs one compilation and one link.
"""
import json
import os
import re
import shlex
import subprocess
import tempfile

TIMEOUT_S = 240  # of one run of a test program that takes half a minute

UNITY = re.compile(r"unity_\d+_cxx\.cxx")


class Broken(Exception):
    """The bench itself does not work: nothing is known about the mutant."""


class Refused(Exception):
    """The compiler does not accept the mutant."""


def run(command, cwd, timeout_s=None, temporary=None):
    environment = os.environ | ({"TMPDIR": temporary, "TEST_TMPDIR": temporary} if temporary else {})
    return subprocess.run(command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", timeout=timeout_s, check=False, env=environment)


def without_precompiled(words):
    """A command that reads headers as text, as one must whose macros are not those that headers were compiled with."""
    words = [word for word in words if word != "-Winvalid-pch"]
    clang = ["-Xclang", "-include-pch", "-Xclang"]
    return [word for i, word in enumerate(words)
            if not any(words[i - k:i - k + 3] == clang for k in range(4) if i >= k)]


class Build:
    """What a build folder knows: how to compile each source, how to link each test program."""

    def __init__(self, root, folder):
        self.root = root
        self.folder = folder
        try:
            with open(os.path.join(folder, "compile_commands.json"), encoding="utf-8") as file:
                commands = json.load(file)
        except OSError as error:
            raise Broken(f"{folder} is no configured build folder: {error.strerror}") from error
        self.compile_of = {}  # object, as ninja names it -> (source, command)
        for entry in commands:
            words = shlex.split(entry["command"])
            self.compile_of[words[words.index("-o") + 1]] = (entry["file"], words)
        self.links = {}
        self.including = {}

    def ninja(self, *words):
        result = run(["ninja", "-C", self.folder, *words], self.folder)
        if result.returncode != 0:
            raise Broken(f"ninja {' '.join(words)}:\n{result.stdout[-4000:]}")
        return result.stdout

    def link_of(self, program):
        if program not in self.links:
            last = self.ninja("-t", "commands", program).strip().splitlines()[-1]
            words = shlex.split(last.removeprefix(": && ").removesuffix(" && :"))
            if "-o" not in words:
                raise Broken(f"cannot tell how {program} is linked: {last}")
            self.links[program] = words
        return self.links[program]

    def program_path(self, program):
        words = self.link_of(program)
        return os.path.join(self.folder, words[words.index("-o") + 1])

    def objects_with(self, path):
        """Objects that a file of the source tree is compiled into: its own, or all that include it, as a header is
        included, or a source where several are compiled as one."""
        source = os.path.join(self.root, path)
        own = [o for o, (file, _) in self.compile_of.items() if file == source]
        if own:
            return own
        if path not in self.including:
            found, current = set(), None
            for line in self.ninja("-t", "deps").splitlines():
                if line and not line.startswith(" "):
                    current = line.split(":")[0]
                elif os.path.normpath(os.path.join(self.folder, line.strip())) == source:
                    found.add(current)
            self.including[path] = sorted(found & set(self.compile_of))
        return self.including[path]

    def archives_of(self, program):
        """Folders of the house's libraries that a program is linked with."""
        words = self.link_of(program)
        return {os.path.dirname(word) for word in words if word.endswith(".a") and not word.startswith("/")}


class Workshop:
    """Compiles and links mutants in a temporary folder.

    Where the build folder compiles several sources as one, an `apart` workshop compiles each alone, and those that are not
    changed only once: a mutant of a large room then costs the compilation of its own file. An `asserting` one compiles the
    mutant with the assertions of the standard library and of Eigen, as builds with sanitizers have them. A workshop that works
    `beside` another uses what that has compiled apart, and must not outlive it.
    """

    def __init__(self, build, apart=False, asserting=False, beside=None):
        self.build = build
        self.apart = apart
        self.asserting = asserting
        self.unchanged = dict(beside.unchanged) if beside else {}
        self.temporary = tempfile.TemporaryDirectory(prefix="kerfbench-mutation-")
        self.folder = self.temporary.name
        self.path = None
        self.objects = {}
        self.programs = {}

    def close(self):
        self.temporary.cleanup()

    def load(self, path, text):
        """From now on programs are built with this text in place of the file's."""
        self.unload()
        self.path = path
        target = os.path.join(self.folder, "overlay", path)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        with open(target, "w", encoding="utf-8") as file:
            file.write(text)

    def unload(self):
        if self.path is not None:
            os.remove(os.path.join(self.folder, "overlay", self.path))
        for file in list(self.objects.values()) + list(self.programs.values()):
            os.remove(file)
        self.path, self.objects, self.programs = None, {}, {}

    def compile(self, name):
        if name not in self.objects:
            source, words = self.build.compile_of[name]
            words = list(words)
            overlay = os.path.join(self.folder, "overlay")
            original = os.path.join(self.build.root, self.path)
            if source == original:
                words[words.index(source)] = os.path.join(overlay, self.path)
            elif UNITY.fullmatch(os.path.basename(source)):
                words[words.index(source)] = self.unity_with_mutant(source, original, overlay)
            out = os.path.join(self.folder, re.sub(r"[^\w.]", "_", name))
            words[words.index("-o") + 1] = out
            words.insert(next(i for i, word in enumerate(words) if word.startswith("-I")), "-I" + overlay)
            result = run(words, self.build.folder)
            if result.returncode != 0:
                raise Refused(result.stdout)
            self.objects[name] = out
        return self.objects[name]

    def members_of(self, name):
        """Sources that an object is compiled from: its own, or all that are compiled as one."""
        source, _ = self.build.compile_of[name]
        if not UNITY.fullmatch(os.path.basename(source)):
            return [source]
        with open(source, encoding="utf-8") as file:
            return re.findall(r'^#include "(.+)"$', file.read(), re.MULTILINE)

    def compile_apart(self, name):
        """The same as an object, but as one object for each of its sources; the mutant among them, if one is loaded."""
        objects = []
        original = None if self.path is None else os.path.join(self.build.root, self.path)
        for member in self.members_of(name):
            kept = self.objects if member == original else self.unchanged
            if member not in kept:
                kept[member] = self.compile_member(name, member, member == original)
            objects.append(kept[member])
        return objects

    def compile_member(self, name, member, changed):
        source, words = self.build.compile_of[name]
        words = list(words)
        relative = os.path.relpath(member, self.build.root)
        words[words.index(source)] = os.path.join(self.folder, "overlay", relative) if changed else member
        words[words.index("-o") + 1] = out = os.path.join(
            self.folder, re.sub(r"[^\w.]", "_", relative) + (".changed.o" if changed else ".o"))
        if changed and self.asserting:
            words = without_precompiled(words) + ["-UNDEBUG", "-D_GLIBCXX_ASSERTIONS"]
        result = run(words, self.build.folder)
        if result.returncode != 0:
            raise Refused(result.stdout) if changed else Broken(f"{member} does not compile alone:\n{result.stdout}")
        return out

    def unity_with_mutant(self, source, original, overlay):
        """A copy of a source that includes several, with the mutant in place of the original if it is one of them."""
        with open(source, encoding="utf-8") as file:
            text = file.read()
        copy = os.path.join(overlay, os.path.basename(source))
        with open(copy, "w", encoding="utf-8") as file:
            file.write(text.replace(original, os.path.join(overlay, self.path)))
        return copy

    def program(self, name):
        """Path of the test program with the mutant in it."""
        if name not in self.programs:
            words = list(self.build.link_of(name))
            folders = self.build.archives_of(name)
            extra = []
            for item in self.build.objects_with(self.path):
                if item in words:
                    words[words.index(item)] = self.compile(item)
                elif any(item.startswith(folder + "/") for folder in folders):
                    extra += self.compile_apart(item) if self.apart else [self.compile(item)]
            if not extra and self.path.startswith("hil/"):
                raise Broken(f"{self.path} is no part of {name}")
            self.programs[name] = self.link(name, words, extra, f"with a changed {self.path}")
        return self.programs[name]

    def program_apart(self, name, paths):
        """Path of the test program without any change, but with all that is compiled as one with these sources apart."""
        folders = self.build.archives_of(name)
        items = sorted({item for path in paths for item in self.build.objects_with(path)
                        if any(item.startswith(folder + "/") for folder in folders)})
        extra = [out for item in items for out in self.compile_apart(item)]
        return self.link(name, list(self.build.link_of(name)), extra, "without any change")

    def link(self, name, words, extra, what):
        out = os.path.join(self.folder, name)
        at = words.index("-o")
        words[at + 1] = out
        words[at:at] = extra
        result = run(words, self.build.folder)
        if result.returncode != 0:
            raise Broken(f"linking {name} {what}:\n{result.stdout[-4000:]}")
        return out


def first_failure(path, test_filter, cwd, timeout_s=TIMEOUT_S):
    """None if all tests pass; else the first that does not, or that crashes; TimeoutExpired if they never end. What the
    tests write for a while they write beside the program, out of the way of others of its kind."""
    with tempfile.TemporaryDirectory(dir=os.path.dirname(path)) as temporary:
        command = [path, f"--gtest_filter={test_filter}", "--gtest_fail_fast", "--gtest_color=no"]
        result = run(command, cwd, timeout_s, temporary)
    if result.returncode == 0:
        if re.search(r"^\[  PASSED  \] 0 tests", result.stdout, re.MULTILINE):
            raise Broken(f"no test of {path} matches {test_filter}")
        return None
    failed = re.search(r"^\[  FAILED  \] (\S+?)(?:,| \()", result.stdout, re.MULTILINE)
    if failed:
        return failed.group(1)
    begun = re.findall(r"^\[ RUN      \] (\S+)", result.stdout, re.MULTILINE)
    suite = re.findall(r"^\[-+\] \d+ tests? from (\S+)", result.stdout, re.MULTILINE)
    if not begun and suite and result.returncode < 0:
        return suite[-1] + " (crash in its set-up)"
    if not begun:
        raise Broken(f"{path} ended with {result.returncode} before any test:\n{result.stdout[-2000:]}")
    return begun[-1] + " (crash)"
