# SPDX-License-Identifier: Apache-2.0
"""From POV-Ray's rays to a camera's picture: lens blur, pixels, noise, 8 bits. Nothing of the product's takes part."""
import dataclasses
import struct
import zlib

import numpy

VERSION = 1                     # Of pixels(): pictures that are kept are of this one.
WHITE = 65535.0


@dataclasses.dataclass(frozen=True)
class Sensor:
    blur_px: float = 0.7            # Whole blur, the pixel's own area included.
    read_noise_gray: float = 0.8
    full_well_electrons: float = 10000.0


def read_pgm(path):
    """Grey of 8 or 16 bits as 0 … 1."""
    with open(path, "rb") as file:
        data = file.read()
    fields, at = [], 0
    while len(fields) < 4:
        end = at
        while not data[end:end + 1].isspace():
            end += 1
        if data[at:at + 1] == b"#":
            at = data.index(b"\n", at) + 1
            continue
        if end > at:
            fields.append(data[at:end])
        at = end + 1
    if fields[0] != b"P5":
        raise ValueError(f"{path}: no binary PGM")
    wide, tall, top = map(int, fields[1:])
    pixels = numpy.frombuffer(data, ">u2" if top > 255 else "u1", wide * tall, at)
    return pixels.reshape(tall, wide).astype(numpy.float32) / top


def write_pgm(path, rows):
    with open(path, "wb") as file:
        file.write(b"P5\n%d %d\n255\n" % (len(rows[0]), len(rows)))
        file.writelines(bytes(row) for row in rows)


def write_png(path, picture):
    """Grey of 8 bits."""
    tall, wide = picture.shape
    lines = numpy.concatenate([numpy.zeros((tall, 1), numpy.uint8), picture], axis=1).tobytes()

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", wide, tall, 8, 0, 0, 0, 0)) +
                   chunk(b"IDAT", zlib.compress(lines, 1)) + chunk(b"IEND", b""))


def smoothed(picture, sigma):
    """Gaussian, one axis after the other, the border repeated."""
    reach = int(numpy.ceil(5.0 * sigma))
    taps = numpy.exp(-0.5 * (numpy.arange(-reach, reach + 1) / sigma) ** 2).astype(numpy.float32)
    taps /= taps.sum()
    for axis in (0, 1):
        padded = numpy.pad(picture, [(reach, reach) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
        length = picture.shape[axis]
        picture = sum(tap * (padded[i:i + length] if axis == 0 else padded[:, i:i + length]) for i, tap in enumerate(taps))
    return picture


def pixels(rays, per_pixel, sensor):
    """A grid of per_pixel x per_pixel rays a pixel as grey of 16 bits, blurred, without noise."""
    # Each ray of the grid stands for its own area, and pixels are the sum of these: 1/12 px² of the whole blur.
    sigma = per_pixel * numpy.sqrt(sensor.blur_px ** 2 - 1.0 / 12.0)
    rays = smoothed(rays, sigma)
    tall, wide = (n // per_pixel for n in rays.shape)
    binned = rays.reshape(tall, per_pixel, wide, per_pixel).mean(axis=(1, 3))
    return numpy.rint(WHITE * binned).astype(numpy.uint16)


def exposed(clean, sensor, seed):
    """A picture of 8 bits, with noise of the sensor and of the light."""
    gray = clean.astype(numpy.float64) * (255.0 / WHITE)
    variance = sensor.read_noise_gray ** 2 + gray * 255.0 / sensor.full_well_electrons
    noise = numpy.random.Generator(numpy.random.PCG64(seed)).standard_normal(gray.shape)
    return numpy.clip(numpy.rint(gray + numpy.sqrt(variance) * noise), 0, 255).astype(numpy.uint8)
