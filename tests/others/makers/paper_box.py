# SPDX-License-Identifier: Apache-2.0
"""Has boxes.py (github.com/florianfesti/boxes) write its PaperBox as a tuck box of 30 x 15 x 45 mm as SVG. Run in its folder."""
import sys

import typing_extensions

sys.path.insert(0, ".")
# Debian 12's typing_extensions is older than these two decorators, which say nothing to a program that runs.
typing_extensions.override = lambda function: function
typing_extensions.deprecated = lambda *_args, **_keys: lambda function: function
from boxes.generators.paperbox import PaperBox  # noqa: E402

box = PaperBox()
box.parseArgs(["--design=tuckbox", "--x=30", "--y=15", "--h=45", "--burn=0", "--reference=0", "--format=svg"])
box.open()
box.render()
sys.stdout.buffer.write(box.close().getvalue())
