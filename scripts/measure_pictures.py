#!/usr/bin/env python3
"""Renders the pictures of docs/images/measure: a two-material bar at rest and stretched, and a moving dot.

The pictures are rendered, so that the true lengths are exact (docs/measure.md lists them). The script needs only
Python.
"""

import math
import pathlib
import struct
import zlib

PAPER, RED, BLUE, GREEN, YELLOW = (226, 224, 219), (200, 44, 38), (38, 72, 190), (42, 148, 62), (235, 190, 35)
SAMPLES = 6  # number of samples along each side of a pixel


def png(path, width, height, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    raw = b"".join(b"\0" + bytes(row) for row in rows)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9))
                     + chunk(b"IEND", b""))


def render(path, width, height, scale, paint):
    """Writes a picture of the colours paint(x, y), in mm from the lower left corner of the picture, y up."""
    rows = []
    for j in range(height):
        row = []
        for i in range(width):
            corners = {paint((i + u) / scale, (height - j - v) / scale) for u in (0, 1) for v in (0, 1)}
            if len(corners) == 1:
                row += corners.pop()
                continue
            total = [0, 0, 0]
            for v in range(SAMPLES):
                for u in range(SAMPLES):
                    colour = paint((i + (u + 0.5) / SAMPLES) / scale, (height - j - (v + 0.5) / SAMPLES) / scale)
                    total = [a + b for a, b in zip(total, colour)]
            row += [round(value / SAMPLES ** 2) for value in total]
        rows.append(row)
    png(path, width, height, rows)


def bar(interface, length):
    """Returns the colours of two dots 60 mm apart above a bar of 10 mm, rotated by 2 degrees against the pixels."""
    cosine, sine = math.cos(math.radians(2)), math.sin(math.radians(2))

    def paint(x, y):
        x, y = x - 40, y - 12.5  # turned about the middle of the picture
        x, y = 40 + x * cosine + y * sine, 12.5 + y * cosine - x * sine
        for centre, colour in ((10, GREEN), (70, YELLOW)):
            if math.hypot(x - centre, y - 20) < 2:
                return colour
        if 4 < y < 14 and 8 < x < 8 + length:
            return RED if x < 8 + interface else BLUE
        return PAPER
    return paint


def main():
    folder = pathlib.Path(__file__).resolve().parent.parent / "docs" / "images" / "measure"
    (folder / "track").mkdir(parents=True, exist_ok=True)
    # A is strained by 0.06, B by 0.24
    render(folder / "rest.png", 480, 150, 6, bar(20, 52))
    render(folder / "stretched.png", 480, 150, 6, bar(21.2, 60.88))
    for frame in range(6):
        x, y = 8 + 3 * frame, 8 + 6 * math.sin(0.5 * frame)
        dots = ((4, 22, GREEN), (34, 22, YELLOW), (x, y, RED))
        render(folder / "track" / f"frame_{frame + 1:02}.png", 160, 104, 4,
               lambda u, v: next((c for a, b, c in dots if math.hypot(u - a, v - b) < 2), PAPER))


main()
