# SPDX-License-Identifier: Apache-2.0
"""Grey PNG pictures without another library: rows of bytes, and what a forger does with them."""
import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def chunks(data):
    at = len(SIGNATURE)
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        yield kind, data[at + 8:at + 8 + length]
        at += 12 + length


def chunk(kind, content):
    return struct.pack(">I4s", len(content), kind) + content + struct.pack(">I", zlib.crc32(kind + content))


def with_text(data, text):
    """The same picture with a text beside it that no program needs."""
    end = data.index(b"IEND") - 4
    return data[:end] + chunk(b"tEXt", b"Comment\0" + text) + data[end:]


class Picture:
    """Rows of bytes; a pixel has one or two of them, the higher first."""

    def __init__(self, data):
        parts = list(chunks(data))
        self.header = parts[0][1]
        self.width, self.height, self.bits, colour = struct.unpack(">IIBB", self.header[:10])
        assert colour == 0, "a grey picture was expected"
        self.others = [(kind, content) for kind, content in parts[1:] if kind not in (b"IDAT", b"IEND")]
        self.step = self.bits // 8
        self.rows = self._unfiltered(zlib.decompress(b"".join(content for kind, content in parts if kind == b"IDAT")))

    def _unfiltered(self, raw):
        size = self.width * self.step
        rows, above = [], bytearray(size)
        for number in range(self.height):
            begin = number * (size + 1)
            kind, row = raw[begin], bytearray(raw[begin + 1:begin + 1 + size])
            self._unfilter(kind, row, above)
            rows.append(row)
            above = row
        return rows

    def _unfilter(self, kind, row, above):
        step = self.step
        if kind == 0:
            return
        for i, _ in enumerate(row):
            left = row[i - step] if i >= step else 0
            corner = above[i - step] if i >= step else 0
            row[i] = (row[i] + (left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner))[kind - 1]) & 255

    def png(self):
        raw = b"".join(b"\0" + bytes(row) for row in self.rows)
        return (SIGNATURE + chunk(b"IHDR", self.header) + b"".join(chunk(*other) for other in self.others)
                + chunk(b"IDAT", zlib.compress(raw, 1)) + chunk(b"IEND", b""))


def paeth(left, above, corner):
    guess = left + above - corner
    apart = (abs(guess - left), abs(guess - above), abs(guess - corner))
    return (left, above, corner)[apart.index(min(apart))]
