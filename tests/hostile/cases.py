# SPDX-License-Identifier: Apache-2.0
"""What a hostile file is, and the kinds that any reader can be given."""
import os
import pathlib
import random
import socket
import stat
import zlib

MIB = 1 << 20
SECRET = "kb7secret"
FOREIGN = f"root:*:{SECRET}0:0:99999:7:::\n{SECRET}token={SECRET}value\n{SECRET}key: {SECRET}word\n"


class Case:
    """A hostile file, the reader that it is given to, and how it is made. `make(path, draw)` writes it at `path`; what it
    returns, if anything, is the file that the reader is given in its place. `honest`: processor seconds and bytes that its
    content is worth, because it is sound and large. `codes`: further exit codes that are right, such as 75."""

    def __init__(self, reader, kind, make, *, group=None, name=None, suffix=None, honest=None, codes=(), secret=None,
                 named=(), quick=False, extra=()):
        self.reader, self.kind, self.make, self.group = reader, kind, make, group or kind
        self.file_name, self.suffix, self.honest, self.codes, self.secret = name, suffix, honest, codes, secret
        self.named, self.quick, self.extra = list(named), quick, list(extra)

    def name(self):
        return f"{self.reader}/{self.kind}"


def draw_for(case, seed):
    return random.Random(f"{seed}/{case.name()}")


def writes(content):
    """Makes a file of these bytes or this text, or of what a function returns that is called when it is wanted."""
    def make(path, _draw):
        made = content() if callable(content) else content
        path.write_bytes(made.encode() if isinstance(made, str) else made)
    return make


def deflated(piece, times):
    """A piece so many times, compressed by zlib."""
    packer = zlib.compressobj(9)
    return b"".join(packer.compress(piece) for _ in range(times)) + packer.flush()


def streams(pieces):
    """Makes a file of pieces, so that a large one takes no memory here."""
    def make(path, _draw):
        with open(path, "wb") as file:
            for piece in pieces():
                file.write(piece if isinstance(piece, bytes) else piece.encode())
    return make


def sparse(path, _draw):
    with open(path, "wb") as file:
        file.truncate(1 << 30)


def sound_and_sparse(sound):
    def make(path, _draw):
        path.write_bytes(sound.read_bytes())
        os.truncate(path, 1 << 30)
    return make


def fifo(path, _draw):
    os.mkfifo(path)


def device(path, _draw):
    os.symlink("/dev/zero", path)


def listener(path, _draw):
    place = os.getcwd()
    os.chdir(path.parent)  # A path of a socket has at most 107 bytes.
    try:
        with socket.socket(socket.AF_UNIX) as end:
            end.bind(path.name)
    finally:
        os.chdir(place)
    assert stat.S_ISSOCK(path.stat().st_mode)


def loop(path, _draw):
    os.symlink(path.name, path)


def directory(path, _draw):
    path.mkdir()


def missing(_path, _draw):
    pass


def rubbish(path, draw):
    path.write_bytes(draw.randbytes(4096))


def torn(sound):
    """Bytes of a sound file, some of which are others."""
    def make(path, draw):
        content = bytearray(sound.read_bytes()[:MIB])
        for _ in range(12):
            content[draw.randrange(len(content))] = draw.randrange(256)
        path.write_bytes(content)
    return make


def cut_off(sound, share):
    def make(path, _draw):
        content = sound.read_bytes()
        path.write_bytes(content[:int(share * len(content))])
    return make


def changed(sound, change):
    def make(path, _draw):
        path.write_bytes(change(sound.read_bytes()))
    return make


def common(reader, sound, is_text, any_size=False):
    """The kinds for one reader. `sound` is a file that it takes, from the folder of sound files."""
    honest = (20.0, 256 * MIB) if any_size else None
    png = b"\x89PNG\r\n\x1a\n" + bytes(64)
    made = [
        Case(reader, "empty", writes(b""), quick=reader in ("dxf", "scenario", "vcd", "table-csv", "trace")),
        # What is cut off may be the end of a file's name, and the message is about that one.
        Case(reader, "truncated", cut_off(sound, 0.5), named=["no such file"], quick=reader in ("dxf", "sr", "trace")),
        Case(reader, "truncated by its last bytes", cut_off(sound, 0.995), group="truncated"),
        Case(reader, "binary rubbish", rubbish, quick=reader in ("svg", "machine", "picture")),
        Case(reader, "a few bytes changed", torn(sound), group="binary rubbish"),
        Case(reader, "zeros", writes(bytes(65536)), group="binary rubbish"),
        Case(reader, "wrong magic", writes(png), quick=reader == "suite"),
        Case(reader, "a line of 4 MiB", writes(b"A" * (4 * MIB) + b"\n"), group="long lines"),
        Case(reader, "2 000 000 line feeds", writes(b"\n" * 2_000_000), group="long lines"),
        Case(reader, "directory", directory, group="no file"),
        Case(reader, "missing", missing, group="no file"),
        Case(reader, "FIFO", fifo, group="no file"),
        Case(reader, "device", device, group="no file"),
        Case(reader, "socket", listener, group="no file"),
        Case(reader, "symlink loop", loop, group="no file"),
        Case(reader, "1 GB, sparse", sparse, group="size", honest=honest),
        Case(reader, "sound, then zeros to 1 GB", sound_and_sparse(sound), group="size", honest=honest),
        Case(reader, "name with escape sequences", writes(b"A"), name="a\x1b]0;x\x07\x1b[31mb", group="names",
             quick=reader in ("dxf", "trace")),
        Case(reader, "name with line feed and workflow command", writes(b"A"), name="a\n::set-output name=x::y", group="names"),
        Case(reader, "name that is no UTF-8", writes(b"A"), name=os.fsdecode(b"a\xff\xc0\xafb"), group="names"),
    ]
    if is_text:
        made += [
            Case(reader, "BOM", changed(sound, lambda text: b"\xef\xbb\xbf" + text), group="encoding"),
            Case(reader, "CRLF", changed(sound, lambda text: text.replace(b"\n", b"\r\n")), group="encoding"),
            Case(reader, "UTF-16", changed(sound, lambda text: text.decode("utf-8", "replace").encode("utf-16")), group="encoding"),
            Case(reader, "invalid UTF-8", changed(sound, lambda text: text.replace(b"e", b"\xff\xfe\xc0")), group="encoding"),
            Case(reader, "control characters", changed(sound, lambda text: text.replace(b"e", b"\x1b[2J\x07\xc2\x9b31m")),
                 group="encoding", quick=reader in ("svg", "scenario", "vcd", "table-csv")),
            Case(reader, "foreign file", writes(FOREIGN), group="foreign", secret=SECRET),
        ]
    return made


def path_in(folder, case, suffix):
    return pathlib.Path(folder) / ((case.file_name or "hostile") + (suffix if case.suffix is None else case.suffix))
