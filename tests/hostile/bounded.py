# SPDX-License-Identifier: Apache-2.0
"""Runs a command within limits, and says what it took and what of it is wrong."""
import multiprocessing
import os
import re
import resource
import signal
import subprocess
import tempfile
import threading

MIB = 1 << 20
MOST_CPU_S = 1.0            # Beside what a sound file takes.
MOST_MEMORY = 256 * MIB
MOST_WORDS = 64 * 1024      # Bytes on the terminal.
STOP_CPU_S, STOP_WALL_S, STOP_MEMORY = 20, 900, 6 << 30  # The time on the clock is that of a computer with much else to do.
STOP_ASLEEP_S = 30        # So long a child may think (20 s), and the bench wait for it.
CODES = (0, 1, 3, 4, 64, 65)
REFUSALS = (2, 64, 65)
# What a terminal would obey: C0 but line feed and tab, DEL, C1. Bytes that are no UTF-8 count as well.
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ufffd]")
# GitHub and Azure obey these in a log, the first at the begin of a line, the others anywhere.
WORKFLOW = re.compile(r"^\s*::|##\[|##vso\[|##teamcity\[", re.MULTILINE)


class Outcome:
    """What a command did: exit code or signal, processor time, peak memory, words."""

    def __init__(self, code, cpu_s, memory, words, hung, talked):
        self.code, self.cpu_s, self.memory, self.words, self.hung, self.talked = code, cpu_s, memory, words, hung, talked

    def ended(self):
        if self.hung:
            return "hang"
        return signal.Signals(-self.code).name if self.code < 0 else str(self.code)

    def first_line(self):
        for line in self.words.splitlines():
            if line.strip():
                return line.strip()
        return ""


def _limit():
    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (STOP_CPU_S, STOP_CPU_S))
    resource.setrlimit(resource.RLIMIT_AS, (STOP_MEMORY, STOP_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _asks_nobody(pid):
    """Whether a process waits in the kernel for a file to be opened or read, as those do that were given a FIFO."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii", errors="replace") as file:
            fields = file.read().rpartition(")")[2].split()
    except OSError:
        return False
    return fields[0] == "S" and int(fields[11]) + int(fields[12]) < 100  # Hundredths of a second.


def _watch(pid, over, hung):
    """Kills a process that does not end: one that sleeps from its begin on, sooner."""
    asleep = 0
    for _ in range(STOP_WALL_S):
        if over.wait(1.0):
            return
        asleep = asleep + 1 if _asks_nobody(pid) else 0
        if asleep >= STOP_ASLEEP_S:
            break
    hung.set()
    os.killpg(pid, signal.SIGKILL)


def run_here(command, folder):
    """Runs it in a folder with nothing of the user's environment; standard output and error are taken together."""
    temporary = os.path.join(folder, "tmp")
    os.makedirs(temporary, exist_ok=True)
    environment = {"PATH": os.environ.get("PATH", "/usr/bin:/bin"), "HOME": temporary, "TMPDIR": temporary, "LANG": "C.UTF-8"}
    with tempfile.TemporaryFile() as words:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=words, stderr=subprocess.STDOUT, cwd=folder, env=environment,
                                   preexec_fn=_limit)
        over, hung = threading.Event(), threading.Event()
        watch = threading.Thread(target=_watch, args=(process.pid, over, hung))
        watch.start()
        _, status, usage = os.wait4(process.pid, 0)
        over.set()
        watch.join()
        process.returncode = os.waitstatus_to_exitcode(status)
        try:
            os.killpg(process.pid, signal.SIGKILL)  # What it may have left.
        except ProcessLookupError:
            pass
        talked = words.seek(0, os.SEEK_END)
        words.seek(0)
        text = words.read(4 * MIB).decode("utf-8", "replace")
    return Outcome(process.returncode, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, text, hung.is_set(), talked)


class Runner:
    """A small process that runs the commands: the kernel counts the memory of whoever starts one as its own."""

    def __init__(self):
        self.ours, theirs = multiprocessing.Pipe()
        self.process = multiprocessing.Process(target=self._serve, args=(theirs,), daemon=True)
        self.process.start()

    @staticmethod
    def _serve(end):
        while (asked := end.recv()) is not None:
            end.send(run_here(*asked))

    def run(self, command, folder):
        self.ours.send((command, folder))
        return self.ours.recv()

    def stop(self):
        self.ours.send(None)
        self.process.join()


def shown(name):
    """A file's name as a message may have it: what a terminal would obey is replaced."""
    return CONTROL.sub("?", os.fsencode(name).decode("utf-8", "replace").replace("\n", "?").replace("\t", "?"))


def faults(case, outcome, sound):
    """What is wrong with the way in which a hostile file was taken; empty: nothing."""
    wrong = []
    if outcome.hung:
        wrong.append(f"does not end: {STOP_CPU_S} s of processor, or {STOP_ASLEEP_S} s asleep")
    elif outcome.code < 0:
        wrong.append(f"ended by {outcome.ended()}")
    elif outcome.code not in CODES + tuple(case.codes):
        wrong.append(f"exit code {outcome.code}")
    cpu_s, memory = case.honest or (MOST_CPU_S, MOST_MEMORY)
    if outcome.cpu_s > cpu_s + sound.cpu_s:
        wrong.append(f"{outcome.cpu_s:.1f} s of processor")
    if outcome.memory > max(memory, sound.memory + memory // 4):
        wrong.append(f"{outcome.memory // MIB} MiB of memory")
    # A name is told by its first letters where it is very long.
    if outcome.code in REFUSALS and not any(shown(name)[:60] in outcome.words for name in case.named):
        wrong.append("the message names no file")
    if found := CONTROL.search(outcome.words):
        wrong.append(f"control character U+{ord(found[0]):04X} on the terminal")
    if WORKFLOW.search(outcome.words):
        wrong.append("a line that a CI server obeys")
    if outcome.talked > MOST_WORDS:
        wrong.append(f"{outcome.talked // 1024} KiB of words")
    if case.secret and case.secret in outcome.words:
        wrong.append("shows lines of a foreign file")
    return wrong
