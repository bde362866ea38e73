# SPDX-License-Identifier: Apache-2.0
"""Recordings, traces, tables, pictures and images of firmware that are made to harm."""
import struct
import zipfile
import zlib

from cases import MIB, Case, deflated, streams, writes
from readers import WIRES, metadata, png, session

HEADER = "$timescale 1 us $end\n$scope module pins $end\n" + "".join(
    f"$var wire 1 {chr(33 + i)} {name} $end\n" for i, name in enumerate(WIRES)) + "$upscope $end\n$enddefinitions $end\n"
MAGIC = b"\x89MCAP0\r\n"


def vcd_cases():
    def edges():
        yield HEADER
        for tick in range(1, 2_000_001):
            yield f"#{tick}\n{tick % 2}!\n"
    return [
        Case("vcd", "stamp 2^64", writes(HEADER + "#0\n0!\n#18446744073709551616\n1!\n"), group="numbers"),
        Case("vcd", "stamp -1", writes(HEADER + "#-1\n1!\n"), group="numbers"),
        Case("vcd", "stamps that go back", writes(HEADER + "#10\n1!\n#5\n0!\n"), group="numbers"),
        Case("vcd", "stamp 2^63", writes(HEADER + "#0\n0!\n#9223372036854775807\n1!\n"), group="numbers", quick=True),
        Case("vcd", "time scale of 0", writes(HEADER.replace("1 us", "0 us") + "#1\n1!\n"), group="numbers"),
        Case("vcd", "header without end", writes(HEADER.replace("$end\n$enddefinitions", "$enddefinitions")), group="truncated"),
        Case("vcd", "10^5 wires", writes("$timescale 1 us $end\n" + "".join(f"$var wire 1 a{i} w{i} $end\n" for i in range(100_000)) +
             "$enddefinitions $end\n#1\n"), group="entities"),
        Case("vcd", "2 000 000 edges", streams(edges), group="entities", honest=(20.0, 1024 * MIB)),
        Case("vcd", "scopes 10^5 deep", writes("$scope module a $end\n" * 100_000 + HEADER), group="deep nesting"),
        Case("vcd", "wire with escape sequences", writes(HEADER.replace("galvo_x_dir", "\x1b[31m\x1b]0;x\x07")), group="terminal", quick=True),
        Case("vcd", "problem with escape sequences", writes(HEADER + "$comment kerfbench problem %1B]0;x%07%0A::set-output name=a::b $end\n#0\n0!\n#5\n1!\n"),
             group="terminal", quick=True),
        Case("vcd", "comment of 4 MiB", writes("$comment " + "x " * 2 * MIB + "$end\n" + HEADER), group="long lines"),
        Case("vcd", "tick of 1 / 2^64 s", writes(HEADER + "$comment kerfbench tick 1/18446744073709551615 $end\n#0\n1!\n#9\n0!\n"), group="numbers"),
        Case("sr", "empty samplerate", writes(session(metadata(""), {"logic-1-1": bytes(1000)})), group="numbers", quick=True),
        Case("sr", "samplerate 0", writes(session(metadata("0 Hz"), {"logic-1-1": bytes(1000)})), group="numbers"),
        Case("sr", "samplerate 10^30", writes(session(metadata("1" + "0" * 30), {"logic-1-1": bytes(1000)})), group="numbers"),
        Case("sr", "parts 2 and 3 are missing", writes(session(metadata(), {"logic-1-1": bytes(1000), "logic-1-4": bytes(1000)})), group="counts"),
        Case("sr", "zip bomb of 4 GiB", zip_bomb, group="amplification", honest=(20.0, 256 * MIB)),
        Case("sr", "metadata of 64 MiB", writes(lambda: session(metadata() + "x" * (64 * MIB), {"logic-1-1": bytes(1000)})), group="amplification"),
        Case("sr", "10^5 channels", writes(session(metadata(wires=[*WIRES, *(f"w{i}" for i in range(100_000))]), {"logic-1-1": bytes(1000)})),
             group="entities"),
        Case("sr", "channel with escape sequences", writes(session(metadata(wires=("\x1b[31m\x07", "b")), {"logic-1-1": bytes(100)})), group="terminal",
             quick=True),
        Case("sr", "unit size 0", writes(session(metadata().replace("unitsize=1", "unitsize=0"), {"logic-1-1": bytes(100)})), group="counts"),
        Case("sr", "unit size 2^64", writes(session(metadata().replace("unitsize=1", "unitsize=18446744073709551616"),
             {"logic-1-1": bytes(100)})), group="counts"),
        Case("sr", "parts named ../up", writes(session(metadata().replace("logic-1", "../../etc/passwd"), {"../../etc/passwd-1": bytes(100)})),
             group="paths"),
    ]


def zip_bomb(path, _draw):
    """4 GiB of samples that do not change: 4 MiB of file."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, allowZip64=True) as archive:
        archive.writestr("version", "2")
        archive.writestr("metadata", metadata())
        piece = bytes(4 * MIB)
        with archive.open("logic-1-1", "w", force_zip64=True) as part:
            for _ in range(1024):
                part.write(piece)


def record(kind, content, length=None):
    return struct.pack("<BQ", kind, len(content) if length is None else length) + content


def text(words):
    return struct.pack("<I", len(words)) + words


def trace_cases():
    header = MAGIC + record(1, text(b"kerfbench") + text(b"x"))
    bomb = zlib.compress(bytes(MIB))

    def chunk(size, compression, content):
        return record(6, struct.pack("<QQQI", 0, 0, size, 0) + text(compression) + struct.pack("<Q", len(content)) + content)
    end = record(15, bytes(20)) + MAGIC
    topic = b"\x1b[31m\x1b]0;x\x07\n::set-output name=a::b"
    made = []
    for reader in ("trace", "trace part"):
        made += [
            Case(reader, "record of 2^63 bytes", writes(header + record(3, b"x", 1 << 63) + end), group="counts", quick=reader == "trace"),
            Case(reader, "record of 2^64 - 1 bytes", writes(header + record(3, b"x", (1 << 64) - 1) + end), group="counts"),
            Case(reader, "chunk that says 2^60 bytes", writes(header + chunk(1 << 60, b"zstd", bomb) + end), group="amplification"),
            Case(reader, "chunk that says 4 GiB", writes(header + chunk(1 << 32, b"", b"x") + end), group="amplification"),
            Case(reader, "chunk of an unknown compression", writes(header + chunk(10, b"\x1b[31m", b"x") + end), group="terminal"),
            Case(reader, "zstd of 1 GiB", writes(header + chunk(1 << 30, b"zstd", zstd_of_nothing(1 << 30)) + end), group="amplification"),
            Case(reader, "10^5 empty records", writes(header + record(99, b"") * 100_000 + end), group="entities"),
            Case(reader, "topic with escape sequences", writes(header + record(4, struct.pack("<HH", 1, 0) + text(topic) + text(b"json") +
                 struct.pack("<I", 0)) + end), group="terminal", quick=True),
            Case(reader, "metadata with escape sequences", writes(header + record(12, text(b"run") + text(text(b"scenario") + text(topic))) + end),
                 group="terminal"),
            Case(reader, "text of 2^32 - 1 bytes", writes(header + record(4, struct.pack("<HHI", 1, 0, 0xffffffff)) + end), group="counts"),
        ]
    return made


def zstd_of_nothing(size):
    """A frame of zstd with runs of zeros: 4 bytes for each 128 KiB."""
    frame = struct.pack("<IBQ", 0xFD2FB528, 0xE0, size)
    blocks = -(-size // 131072)
    for i in range(blocks):
        last = int(i == blocks - 1)
        frame += struct.pack("<I", last | 1 << 1 | 131072 << 3)[:3] + b"\0"
    return frame


def table_cases():
    nan = "x_mm,y_mm,dx_mm,dy_mm\n" + "".join(f"{x},{y},nan,inf\n" for y in range(3) for x in range(3))
    return [
        Case("table-csv", "not a number", writes(nan), group="numbers", quick=True),
        Case("table-csv", "1e308", writes(nan.replace("nan", "1e308").replace("inf", "-1e308")), group="numbers"),
        Case("table-csv", "10^6 rows", writes("x_mm,y_mm,dx_mm,dy_mm\n" + "".join(f"{i},0,0,0\n" for i in range(1_000_000))), group="entities",
             honest=(5.0, 256 * MIB)),
        Case("table-csv", "cells with formulas and escapes", writes("x_mm,y_mm,dx_mm,dy_mm\n=1+1,\x1b[31m,@x,-\n"), group="terminal"),
        Case("table-csv", "2^31 nodes said", writes("# nodes: 2147483648 x 2147483648\nx_mm,y_mm,dx_mm,dy_mm\n0,0,0,0\n"), group="counts"),
        Case("table-header", "2^31 columns", writes("#define A_COLUMNS 2147483648\n#define A_ROWS 99999999999999999999\n"), group="counts"),
        Case("table-header", "array without end", writes("static const int16_t A_DX[] = {" + "1," * 500_000), group="truncated",
             honest=(2.0, 256 * MIB)),
        Case("table-grid", "10^6 rows", writes("".join(f"{i} 0 0 0\n" for i in range(1_000_000))), group="entities", honest=(5.0, 256 * MIB)),
        Case("table-grid", "not a number", writes("nan nan nan nan\n" * 9), group="numbers"),
        Case("nine points", "index 10^30", writes("1" + "0" * 30 + " 0 0 0\n" * 9), group="numbers"),
        Case("table-cor1", "scale not a number", writes("LMC1COR_1.0".encode("utf-16-le") + bytes(0x170 - 22) + struct.pack("<d", float("nan")) +
             bytes(68128 - 0x178)), group="numbers"),
        Case("table-cor2", "values beyond the board's", writes(b"JCZ_COR_2_1" + bytes(17) + struct.pack("<d", 400.0) +
             b"\xff\xff\xff\x7f" * 8450), group="numbers"),
        Case("correction", "10^6 rows", writes("x_mm,y_mm,dx_mm,dy_mm\n" + "".join(f"{i},0,0,0\n" for i in range(1_000_000))), group="entities",
             honest=(5.0, 256 * MIB)),
    ]


def picture_cases():
    jpeg = b"\xff\xd8\xff\xc0" + struct.pack(">HBHHB", 11, 8, 65500, 65500, 1) + b"\x01\x11\x00\xff\xd9"
    tiff = b"II*\0" + struct.pack("<IH", 8, 3) + b"".join(
        struct.pack("<HHII", tag, 4, 1, value) for tag, value in ((256, 60000), (257, 60000), (258, 8))) + bytes(4)
    return [
        Case("picture", "PNG of 30 000 x 30 000", writes(lambda: png(30_000, 30_000, rows=deflated(bytes(30_001), 30_000))), group="amplification"),
        Case("picture", "PNG that says 2^31 x 2^31", writes(png((1 << 31) - 1, (1 << 31) - 1, rows=b"x")), group="counts", quick=True),
        Case("picture", "PNG of 0 x 0", writes(png(0, 0)), group="counts"),
        Case("picture", "PNG whose rows are missing", writes(png(5000, 5000, rows=zlib.compress(b"x"))), group="truncated"),
        Case("picture", "JPEG of 65500 x 65500", writes(jpeg), suffix=".jpg", group="counts"),
        Case("picture", "TIFF of 60000 x 60000", writes(tiff), suffix=".tif", group="counts"),
        Case("picture", "TIFF whose directory is its own next", writes(b"II*\0" + struct.pack("<IHI", 8, 0, 8)), suffix=".tif", group="cycles"),
        Case("picture", "SVG for a picture", writes("<svg/>"), group="wrong magic"),
        Case("picture", "other codecs (PXM)", writes(b"P5\n60000 60000\n255\n"), suffix=".pgm", group="counts"),
        Case("picture", "OpenEXR", writes(b"v/1\x01" + bytes(100)), suffix=".exr", group="wrong magic"),
    ]


def elf(machine=40, count=0, size=0, offset=52):
    head = b"\x7fELF\x01\x01\x01" + bytes(9) + struct.pack("<HHIIIIIHHHHHH", 2, machine, 1, 0x08000001, offset, 0, 0, 52, 32, count, 40, 0, 0)
    return head + struct.pack("<IIIIIIII", 1, 84, 0x08000000, 0x08000000, size, size, 5, 4) * min(count, 8)


def image_cases():
    return [
        Case("image hex", "record without its sum", writes(":10000000" + "00" * 16 + "\n"), group="truncated"),
        Case("image hex", "address 2^32", writes(":02000004FFFFFC\n:10FFF000" + "AA" * 16 + "61\n:00000001FF\n"), group="numbers"),
        Case("image hex", "10^5 records", writes(":00000000 00\n" * 100_000), group="entities"),
        Case("image hex", "escape sequences", writes("\x1b[31m\x1b]0;x\x07\n"), group="terminal"),
        Case("image elf", "65535 segments", writes(elf(count=65535)), group="counts"),
        Case("image elf", "segment of 4 GiB", writes(elf(count=1, size=0xffffffff)), group="counts", quick=True),
        Case("image elf", "table beyond the file", writes(elf(count=4, offset=0xfffffff0)), group="counts"),
        Case("image elf", "of another processor", writes(elf(machine=62)), group="wrong magic"),
        Case("release", "10^5 records", writes(":00000000 00\n" * 100_000), group="entities"),
    ]
