#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Speaks the pin-stream protocol to controller-native: a short program, its pulses and their timing.

    native_child_test.py path/to/controller-native
"""
import struct
import subprocess
import sys

PORT_A, PORT_L = 0, 11


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021) & 0xFFFF if crc & 0x8000 else crc << 1
    return crc


def frame(kind, seq, payload=b""):
    body = bytes([kind, seq, len(payload)]) + payload
    return b"\xa5" + body + struct.pack("<H", crc16(body))


def job_check(data):
    a, b = 1, 0
    for byte in data:
        a = a + byte & 0xFFFF
        b = b + a & 0xFFFF
    return struct.pack("<HH", a, b)


class Child:
    def __init__(self, path):
        self.process = subprocess.Popen([path], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.watermark = 0

    def send(self, kind, payload=b""):
        self.process.stdin.write(struct.pack("<IB", len(payload), kind) + payload)
        self.process.stdin.flush()

    def receive(self):
        size, kind = struct.unpack("<IB", self.process.stdout.read(5))
        return kind, self.process.stdout.read(size)

    def advance(self, until):
        self.send(4, struct.pack("<Q", until))
        kind, payload = self.receive()
        assert kind == 67
        stop, watermark, count = struct.unpack_from("<BQI", payload)
        assert stop == 0 and watermark == until
        events = [struct.unpack_from("<QHHHH", payload, 13 + 16 * i) for i in range(count)]
        assert all(self.watermark < event[0] <= watermark for event in events)
        assert events == sorted(events, key=lambda event: event[0])
        self.watermark = watermark
        at = 13 + 16 * count
        (size,) = struct.unpack_from("<I", payload, at)
        return events, payload[at + 4:at + 4 + size]


def main():
    child = Child(sys.argv[1])
    child.send(1, struct.pack("<IQIQ", 1, 16_000_000, 250_000, 1_000_000) + struct.pack("<HH", 0, 0))
    kind, _ = child.receive()
    assert kind == 65
    child.send(2, struct.pack("<QHHB", 100, PORT_L, 2, 1))
    program = bytes([0x81, 31]) + bytes([0x81, 0x100 - 31]) + b"\x00"
    config = bytes(17) + bytes([31] * 10) + struct.pack("<10i", *[-(2**31)] * 5, *[2**31 - 1] * 5)
    check = job_check(config + program)
    child.send(3, frame(1, 1) + frame(2, 2, config) + frame(3, 3, program + check) + frame(4, 4, check))
    events, answers = [], b""
    for until in range(7000, 16_000_000 // 10, 7000):  # a quantum that is no multiple of a tick
        more, sent = child.advance(until)
        events += more
        answers += sent
    image = open(sys.argv[1], "rb").read()
    block = image[image.index(b"KERFREL\x01"):][:79]  # controller/release.h
    for expected in (frame(0x83, 1, bytes([3, 0, 16, 144, 1, 32]) + block), frame(0x85, 0, b"\x01\x00"), frame(0x85, 0, b"\x02\x00")):
        assert expected in answers, (expected, answers)
    level, position, rise, changed, edges = 0, 0, None, None, 0
    for tick, port, change, now, _ in events:
        if port != PORT_A:
            continue
        assert level ^ now == change
        level = now
        if change & 2:
            changed = tick
            assert rise is None or tick - rise >= 80
        if change & 1 and now & 1:
            assert changed is None or tick - changed >= 80
            position += 1 if now & 2 else -1
            rise = tick
            edges += 1
        elif change & 1:
            assert tick - rise >= 40
    assert (edges, position) == (62, 0), (edges, position)
    child.send(5)
    assert child.process.wait(5) == 0


if __name__ == "__main__":
    main()
