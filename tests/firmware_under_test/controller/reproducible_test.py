#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The same sources give the same image bytes, wherever they lie: builds the releases in two folders and compares, with the build's own as well.

    reproducible_test.py CMAKE SOURCE VERSION AVR_GCC AVR_OBJCOPY CC FIRMWARE CORE_SOURCES
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

CMAKE, SOURCE, VERSION, AVR_GCC, AVR_OBJCOPY, CC, FIRMWARE, CORE = sys.argv[1:]
CONTROLLER = "firmware_under_test/controller"


def build(root):
    """All sources below `root`, then the AVR image and a native one. Returns their bytes."""
    (root / CONTROLLER).parent.mkdir(parents=True)
    shutil.copytree(pathlib.Path(SOURCE) / CONTROLLER, root / CONTROLLER)
    (root / "hil/source").mkdir(parents=True)
    shutil.copy(pathlib.Path(SOURCE) / "hil/source/pin_stream.h", root / "hil/source")
    out = root / "out"
    out.mkdir()
    header = out / "kb_version.h"
    controller = root / CONTROLLER
    subprocess.run([CMAKE, f"-DSOURCE={root}", f"-DVERSION={VERSION}", f"-DOUT={header}", "-P", controller / "version.cmake"], check=True)
    subprocess.run([CMAKE, f"-DGCC={AVR_GCC}", f"-DOBJCOPY={AVR_OBJCOPY}", f"-DSOURCE={root}", f"-DVERSION_HEADER={header}",
                    f"-DSOURCES={CORE};avr/main.c", "-DDEFINES=", f"-DOUT={out / 'avr'}", "-P", controller / "build_avr.cmake"], check=True)
    native = [controller / name for name in (CORE + ";native/main.c;native/message.c").split(";")]
    subprocess.run([CC, "-O3", "-std=gnu11", "-include", header, f"-I{root}", f"-I{controller / 'native'}", *native, "-o", out / "native"],
                   check=True)
    version = header.read_text()
    return {name: (out / name).read_bytes() for name in ("avr.hex", "native")}, version


def main():
    with tempfile.TemporaryDirectory() as scratch:
        first, version = build(pathlib.Path(scratch) / "a")
        second, other = build(pathlib.Path(scratch) / "quite/another/folder")
        changed = pathlib.Path(scratch) / "a" / CONTROLLER / "core/belt.c"
        changed.write_text(changed.read_text() + "\n")
        subprocess.run([CMAKE, f"-DSOURCE={pathlib.Path(scratch) / 'a'}", f"-DVERSION={VERSION}", f"-DOUT={scratch}/v.h", "-P",
                        changed.parent.parent / "version.cmake"], check=True)
        assert pathlib.Path(scratch, "v.h").read_text() != version, "other sources, another version"
    assert version == other, (version, other)
    for name, image in first.items():
        assert image == second[name], f"{name} depends on where it is built"
    built = pathlib.Path(FIRMWARE, "controller-avr.hex").read_bytes()
    assert built == first["avr.hex"], "the build's own image is another one"
    print("the same bytes three times;", version.strip())


if __name__ == "__main__":
    main()
