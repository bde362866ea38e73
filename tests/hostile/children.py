# SPDX-License-Identifier: Apache-2.0
"""Programs in place of an emulator that answer what is no answer, by the pin stream."""
from cases import Case

HEAD = """#!/usr/bin/python3
import os, struct, sys, time
def read(n):
    data = sys.stdin.buffer.read(n)
    if len(data) < n: sys.exit(0)
    return data
def ask():
    size, kind = struct.unpack("<IB", read(5))
    return kind, read(size)
def put(kind, payload): sys.stdout.buffer.write(struct.pack("<IB", len(payload), kind) + payload); sys.stdout.buffer.flush()
def text(words): return struct.pack("<H", len(words)) + words
def hello(num=1, den=16000000, err=0, name=b"x"): put(65, struct.pack("<IQQI", 1, num, den, err) + text(name))
def batch(until, events=b"", count=None, uart=b"", message=b"", stop=0, heard=None):
    put(67, struct.pack("<BQI", stop, until, len(events) // 16 if count is None else count) + events
        + struct.pack("<I", len(uart) if heard is None else heard) + uart + text(message))
def asked():
    while True:
        kind, payload = ask()
        if kind == 4: return struct.unpack("<Q", payload)[0]
        if kind == 5: sys.exit(0)
ask()
"""
ESCAPES = "b'\\x1b]0;x\\x07\\x1b[31m\\n::set-output name=a::b'"


def child(body):
    def make(path, _draw):
        path.write_text(HEAD + body)
        path.chmod(0o755)
    return make


BODIES = {
    "rubbish for HELLO": ("sys.stdout.buffer.write(os.urandom(4096)); sys.stdout.flush()", "binary rubbish"),
    "HELLO of 4 GiB": ("sys.stdout.buffer.write(struct.pack('<IB', 0xffffffff, 65)); sys.stdout.flush(); time.sleep(100)", "counts"),
    "HELLO of 64 MiB": ("put(65, bytes(64 << 20))", "counts"),
    "tick of 0 s": ("hello(0, 1)\nwhile True: batch(asked())", "numbers"),
    "tick of 1 / 0 s": ("hello(1, 0)\nwhile True: batch(asked())", "numbers"),
    "tick of 1 / 2^64 s": ("hello(1, (1 << 64) - 1)\nwhile True: batch(asked())", "numbers"),
    "name with escape sequences": (f"hello(name={ESCAPES})\nwhile True: batch(asked())", "terminal"),
    "ERROR with escape sequences": (f"put(66, text({ESCAPES}))", "terminal"),
    "ERROR of 64 KiB": ("put(66, text(b'A' * 65535))", "long lines"),
    "message with escape sequences": (f"hello()\nbatch(asked(), stop=2, message={ESCAPES})", "terminal"),
    "standard error of 64 MiB": ("hello()\nfor _ in range(1024): sys.stderr.write('\\x1b[31mx' * 10922)\nwhile True: batch(asked())", "terminal"),
    "dies at once": ("sys.exit(7)", "truncated"),
    "dies in a batch": ("hello()\nasked()\nsys.stdout.buffer.write(b'\\x40\\0\\0\\0C'); sys.stdout.flush()", "truncated"),
    "kills itself": ("os.kill(os.getpid(), 9)", "truncated"),
    "2^32 - 1 events said": ("hello()\nbatch(asked(), count=0xffffffff)", "counts"),
    "2^32 - 1 bytes of the UART said": ("hello()\nbatch(asked(), heard=0xffffffff)", "counts"),
    "watermark that goes back": ("hello()\nasked()\nbatch(0)", "numbers"),
    "watermark 2^64 - 1": ("hello()\nasked()\nbatch((1 << 64) - 1)", "numbers"),
    "event at tick 2^64 - 1": ("hello()\nuntil = asked()\nbatch(until, struct.pack('<QHHHH', (1 << 64) - 1, 0, 1, 1, 0))", "numbers"),
    "port 65535": ("hello()\nuntil = asked()\nbatch(until, struct.pack('<QHHHH', until, 65535, 1, 1, 0))", "numbers"),
    "UART flood": ("hello()\nwhile True: batch(asked(), uart=b'A' * (1 << 20))", "amplification"),
    "unknown reply": ("put(200, b'x')", "wrong magic"),
}


def child_cases():
    quick = ("HELLO of 4 GiB", "ERROR with escape sequences", "2^32 - 1 events said")
    return [Case("child", kind, child(body), group=group, quick=kind in quick, named=["child.txt", "hostile.py"])
            for kind, (body, group) in BODIES.items()]
