#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Nothing of floating point is linked into the AVR image, so there is none in an interrupt. Interrupts call no function but those that are
theirs, and none divides or multiplies in software.

    no_floating_point_test.py OBJDUMP NM IMAGE.elf
"""
import re
import subprocess
import sys

OBJDUMP, NM, IMAGE = sys.argv[1:]
FLOAT = re.compile(r"^__(add|sub|mul|div|neg|cmp|eq|ne|lt|le|gt|ge|unord)?(sf|df)\d?$|^__fp_|^__fix|^__float|^__(add|sub|mul|div|cmp)[sd]f")
HELPER = re.compile(r"__(u?divmod|u?mulhi|u?mulsi|mulu)")


def main():
    names = [line.split()[-1] for line in subprocess.run([NM, IMAGE], check=True, capture_output=True, text=True).stdout.splitlines()]
    assert "__vector_17" in names and "main" in names, "this is not the image"
    found = [name for name in names if FLOAT.search(name)]
    assert not found, f"floating point is linked in: {found}"
    listing = subprocess.run([OBJDUMP, "-d", IMAGE], check=True, capture_output=True, text=True).stdout
    functions = dict(re.findall(r"^[0-9a-f]+ <(\w+)>:\n(.*?)(?=^[0-9a-f]+ <|\Z)", listing, re.S | re.M))
    vectors = {name: code for name, code in functions.items() if re.fullmatch(r"__vector_\d+", name)}
    assert len(vectors) >= 5, sorted(vectors)
    for name, code in vectors.items():
        assert code.count("reti") >= 1, name
        calls = re.findall(r"\b(?:r?call)\s+\S+\s*;?\s*(\S+.*)", code)
        assert not calls, f"{name} calls {calls}"
        assert not HELPER.search(code), f"{name} calculates in software"
    print(f"{len(names)} names, none of floating point; {len(vectors)} interrupts without a call:", ", ".join(sorted(vectors)))


if __name__ == "__main__":
    main()
