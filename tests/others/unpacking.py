# SPDX-License-Identifier: Apache-2.0
"""Files of other people's repositories, at a commit, from clones with a work tree or without."""
import io
import os
import subprocess
import tarfile


class Missing(Exception):
    """Something that is not where it should be, in words."""


def clone_of(top, name):
    """The git folder of a clone."""
    for inside in (name, os.path.join(name, ".git"), name + ".git"):
        if os.path.isfile(os.path.join(top, inside, "HEAD")):
            return os.path.join(top, inside)
    raise Missing(f"{os.path.join(top, name)} is no clone")


def unpack(top, name, commit, wanted, into):
    """Puts the files that git's path patterns want into a folder. Returns their names there, sorted."""
    packed = subprocess.run(["git", "--git-dir", clone_of(top, name), "archive", "--format=tar", commit, "--", *wanted],
                            capture_output=True, check=False)
    if packed.returncode != 0:
        raise Missing(f"{name}, {commit}: {packed.stderr.decode().strip()}")
    with tarfile.open(fileobj=io.BytesIO(packed.stdout)) as archive:
        names = sorted(member.name for member in archive if member.isfile())
        archive.extractall(into)
    return names


def all_of(top, name, commit, into):
    return unpack(top, name, commit, ["."], into)
