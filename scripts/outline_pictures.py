#!/usr/bin/env python3
"""Renders the pictures of docs/images/outline: a finger under 0, 700 and 1200 kPa, dark on paper, from its side.

The pictures are rendered, so that their parameters are exact (docs/poses.md): 38 MPa, a base rotated by 2 degrees and
lifted by 1.5 mm. The script needs only Python and build/softkin.
"""

import math
import pathlib
import struct
import subprocess
import tempfile
import zlib

PAPER, INK, RED, GREEN = (226, 224, 219), (38, 38, 42), (200, 44, 38), (42, 148, 62)
SCALE, WIDTH, HEIGHT = 3, 372, 420  # pixels in a mm; pixels
LEFT, TOP = 6, 40  # x and z of the picture's upper left corner [mm]: the base is outside of the picture
SAMPLES = 4  # number of samples along each side of a pixel
DOTS = ((20, 34, RED), (120, 34, GREEN))


def png(path, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    raw = b"".join(b"\0" + bytes(row) for row in rows)
    header = struct.pack(">IIBBBBB", WIDTH, HEIGHT, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9))
                     + chunk(b"IEND", b""))


def triangles(path):
    """Yields x and z of the corners of each triangle of a binary STL."""
    data = path.read_bytes()
    for i in range(struct.unpack_from("<I", data, 80)[0]):
        corners = struct.unpack_from("<9f", data, 84 + 50 * i + 12)
        yield [(corners[k], corners[k + 2]) for k in (0, 3, 6)]


def to_sample(x, z):
    """Applies the pose of the base; returns samples from the upper left corner."""
    turn = math.radians(2)
    x, z = x * math.cos(turn) + z * math.sin(turn), z * math.cos(turn) - x * math.sin(turn) + 1.5
    return (x - LEFT) * SCALE * SAMPLES, (TOP - z) * SCALE * SAMPLES


def covered(path):
    """Returns the rows of samples: 1 where the robot is, else 0."""
    wide, high = WIDTH * SAMPLES, HEIGHT * SAMPLES
    rows = [bytearray(wide) for _ in range(high)]
    for triangle in triangles(path):
        corners = [to_sample(*corner) for corner in triangle]
        low, top = min(v for _, v in corners), max(v for _, v in corners)
        for row in range(max(0, math.ceil(low - 0.5)), min(high - 1, math.floor(top - 0.5)) + 1):
            cuts = []
            for (a, b), (c, d) in zip(corners, corners[1:] + corners[:1]):
                if min(b, d) <= row + 0.5 <= max(b, d) and b != d:
                    cuts.append(a + (c - a) * (row + 0.5 - b) / (d - b))
            if cuts:
                begin, end = max(0, math.ceil(min(cuts) - 0.5)), min(wide - 1, math.floor(max(cuts) - 0.5)) + 1
                if begin < end:
                    rows[row][begin:end] = b"\1" * (end - begin)
    return rows


def render(path, robot):
    """Writes the picture of the covered samples."""
    rows = []
    for j in range(HEIGHT):
        row = []
        for i in range(WIDTH):
            total = [0, 0, 0]
            for v in range(SAMPLES):
                for u in range(SAMPLES):
                    x = LEFT + (i + (u + 0.5) / SAMPLES) / SCALE
                    z = TOP - (j + (v + 0.5) / SAMPLES) / SCALE
                    colour = INK if robot[j * SAMPLES + v][i * SAMPLES + u] else PAPER
                    if z > 30:
                        colour = next((c for a, b, c in DOTS if math.hypot(x - a, z - b) < 2.5), colour)
                    total = [a + b for a, b in zip(total, colour)]
            row += [round(value / SAMPLES ** 2) for value in total]
        rows.append(row)
    png(path, rows)


def main():
    root = pathlib.Path(__file__).resolve().parent.parent
    folder = root / "docs" / "images" / "outline"
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        shape, surface = pathlib.Path(name) / "finger.vtu", pathlib.Path(name) / "finger.stl"
        for number, air in enumerate((0, 700, 1200), 1):
            softkin = str(root / "build" / "softkin")
            subprocess.run([softkin, "fk", "docs/scenes/finger_pressure.yaml", "--set", f"air={air}", "-o", str(shape),
                            "--change", "materials.body.youngs_modulus=38"], cwd=root, check=True, capture_output=True)
            subprocess.run([softkin, "mesh", "convert", str(shape), str(surface)], check=True, capture_output=True)
            render(folder / f"finger_{number}.png", covered(surface))


main()
