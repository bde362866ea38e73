# SPDX-License-Identifier: Apache-2.0
"""Folders for results that fail a run: a disk that becomes full, one that becomes read-only, a folder that goes away. They are mounted in a
mount namespace of this process, which needs root."""
import ctypes
import os
import shutil
import subprocess
import time

CLONE_NEWNS = 0x00020000
MS_REC, MS_PRIVATE = 0x4000, 0x40000
# So much is free beside what the results take; a disk with more is not full.
WAYS = ["disk full", "disk full, temporary files", "disk becomes read-only", "results folder removed"]


def own_mounts():
    """Mounts of this process are its own from now on; False without the right to that."""
    libc = ctypes.CDLL(None, use_errno=True)
    return os.geteuid() == 0 and libc.unshare(CLONE_NEWNS) == 0 and libc.mount(None, b"/", None, MS_REC | MS_PRIVATE, None) == 0


def mount(*words):
    subprocess.run(["mount", *words], check=True)


class Disk:
    """A small disk over a folder, unmounted in the end."""

    def __init__(self, folder, size_kib):
        folder.mkdir(exist_ok=True)
        self.folder = folder
        mount("-t", "tmpfs", "-o", f"size={size_kib}k", "kerfbench-ends", str(folder))

    def become_read_only(self):
        # Files that are open for writing keep a disk from that; the run's next one is refused.
        while subprocess.run(["mount", "-o", "remount,ro", str(self.folder)], capture_output=True, check=False).returncode != 0:
            time.sleep(0.001)

    def remove(self):
        subprocess.run(["umount", "-l", str(self.folder)], check=True)


def size_of(folder):
    """KiB of a folder's files, each in whole pages."""
    return sum((path.stat().st_size + 4095) // 4096 * 4 for path in folder.rglob("*") if path.is_file())


def try_place(way, share, whole_s, whole_kib, place):
    """Runs into a bad place. Returns the process, ended, the folder's runs and what it has left, and faults."""
    disk = None
    wrong = []
    try:
        if way == "disk full":
            disk = Disk(place.results, max(64, round(min(share, 0.98) * whole_kib)))
        elif way == "disk full, temporary files":
            disk = Disk(place.top / "tmp", max(4, round(min(share, 0.98) * 64)))
        elif way == "disk becomes read-only":
            disk = Disk(place.results, 4 * whole_kib)
        process = place.start(stderr=subprocess.PIPE, text=True)
        if way == "disk becomes read-only":
            time.sleep(share * whole_s)
            if process.poll() is None:
                disk.become_read_only()
        elif way == "results folder removed":
            time.sleep(share * whole_s)
            if process.poll() is None:
                shutil.rmtree(place.results, ignore_errors=True)
        said = process.communicate(timeout=600)[1]
        code = process.returncode
        if code not in (0, 2, 3, 65):
            wrong.append(f"exit code {code}: {said[-300:]}")
        if code != 0 and not said.strip():
            wrong.append(f"exit code {code}, and no word why")
        runs, rest = place.runs()
        if code == 0 and not runs and way != "results folder removed":
            wrong.append("exit code 0 and no result")
        if way == "disk becomes read-only":
            rest = []  # What nobody can remove any more; the next run does, as after a kill.
        wrong += [f"{name} is left" for name in rest + place.temporaries()]
        for run in runs:
            if why := place.broken(run):
                wrong.append(f"{run.name} is not whole: {why}")
    finally:
        if disk is not None:
            disk.remove()
    return wrong
