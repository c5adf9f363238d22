"""Makes the mesh of the tentacle, and the tables of its measured poses.

    python3 make_tentacle.py [FOLDER] [--coarse]

FOLDER holds poses.csv as measured (README.md says where it comes from); without it the mesh alone is made.
If FOLDER also holds two_tendons.csv, the script writes both_tendons.csv: all poses, with two markers for the two positions of p2.
--coarse makes a mesh of 306 elements for trials.
"""

import csv
import math
import sys
from pathlib import Path

HERE = Path(__file__).parent
PULLEY_M = 0.0325  # radius on which a motor winds its tendon


def radius(z: float) -> float:
    """Of the section [mm] at a distance from the base."""
    if z < 305:
        return 15.41 + (6.42 - 15.41) * z / 305
    return 6.42 + (4.80 - 6.42) * (z - 305) / 55


def disc(around: int, coarse: bool) -> tuple[list[tuple[float, float]], list[tuple[int, int, int]]]:
    """A unit disc: its middle, a ring halfway (not if coarse) and one outside; counterclockwise triangles."""
    points = [(0.0, 0.0)]
    if coarse:
        points += [(math.cos(2 * math.pi * k / around), math.sin(2 * math.pi * k / around)) for k in range(around)]
        return points, [(0, 1 + k, 1 + (k + 1) % around) for k in range(around)]
    for ring, share in ((1, 0.55), (2, 1.0)):
        points += [(share * math.cos(2 * math.pi * k / around), share * math.sin(2 * math.pi * k / around)) for k in range(around)]
    triangles = []
    for k in range(around):
        a, b = 1 + k, 1 + (k + 1) % around
        triangles += [(0, a, b), (a, a + around, b + around), (a, b + around, b)]
    return points, triangles


def mesh(levels: list[float], around: int, coarse: bool = False) -> str:
    """Prisms between the levels, each as three tetrahedra whose diagonals fit those of their neighbours."""
    points, triangles = disc(around, coarse)
    vertices = [(radius(z) * x, radius(z) * y, -z) for z in levels for x, y in points]
    tetrahedra = []
    for level in range(len(levels) - 1):
        for triangle in triangles:
            a, b, c = sorted(level * len(points) + i for i in triangle)
            n = len(points)
            for tetrahedron in ((a, b, c, a + n), (b, c, a + n, b + n), (c, a + n, b + n, c + n)):
                tetrahedra.append(positive(vertices, tetrahedron))
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(vertices))]
    lines += ["%.6f %.6f %.6f 0" % v for v in vertices]
    lines += ["Tetrahedra", str(len(tetrahedra))]
    lines += ["%d %d %d %d 1" % tuple(i + 1 for i in t) for t in tetrahedra]
    return "\n".join(lines + ["End", ""])


def positive(vertices: list[tuple[float, float, float]], t: tuple[int, ...]) -> tuple[int, ...]:
    a, b, c, d = (vertices[i] for i in t)
    u, v, w = ([q - p for p, q in zip(a, x)] for x in (b, c, d))
    volume = sum(u[i] * (v[(i + 1) % 3] * w[(i + 2) % 3] - v[(i + 2) % 3] * w[(i + 1) % 3]) for i in range(3))
    return t if volume > 0 else (t[0], t[1], t[3], t[2])


def poses(folder: Path) -> str:
    lines = []
    with open(folder / "poses.csv", newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        markers = [f"p{m}_{axis}_mm" for m in (1, 2, 3, 4) for axis in "xyz"]
        lines.append(",".join(["t1_N", "t2_N", *markers]))
        for row in rows:
            pulls = [f"{float(row[f'torque{t}_Nm']) / PULLEY_M:.6g}" for t in (1, 2)]
            lines.append(",".join(pulls + [row[name] for name in markers]))
    return "\n".join([*lines, ""])


def both_tendons(folder: Path) -> str:
    """Returns the poses of one and of two tendons. Marker p2 has two positions on the body: p2, and p2a in the second sitting and with both tendons."""
    second_sitting = (1, 3, 5, 8, 10, 12)
    markers = [f"{m}_{axis}_mm" for m in ("p1", "p2", "p2a", "p3", "p4") for axis in "xyz"]
    lines = [",".join(["t1_N", "t2_N", *markers])]
    for name in ("poses.csv", "two_tendons.csv"):
        with open(folder / name, newline="") as file:
            for number, row in enumerate(csv.DictReader(line for line in file if not line.startswith("#")), 1):
                p2 = "p2a" if name == "two_tendons.csv" or number in second_sitting else "p2"
                cells = {f"{p2 if m == 'p2' else m}_{axis}_mm": row[f"{m}_{axis}_mm"] for m in ("p1", "p2", "p3", "p4") for axis in "xyz"}
                pulls = [f"{float(row[f'torque{t}_Nm']) / PULLEY_M:.6g}" for t in (1, 2)]
                lines.append(",".join(pulls + [cells.get(marker, "") for marker in markers]))
    return "\n".join([*lines, ""])


COARSE = [0, 22, 44, 66, 87, 108, 129.1, 152, 174, 197, 219.5, 240, 260, 280, 292.5, 305, 332, 360]


if __name__ == "__main__":
    levels = [0, 12, 24, 36, 48, 60, 72, 84, 96, 108, 119, 129.1, 139, 151, 163, 175, 187, 199, 210, 219.5, 229, 240, 252, 262, 271, 280, 289, 297, 305, 315, 326, 338, 349, 360]
    folders = [Path(argument) for argument in sys.argv[1:] if argument != "--coarse"]
    (HERE / "tentacle.mesh").write_text(mesh(COARSE, 6, coarse=True) if "--coarse" in sys.argv else mesh(levels, 8))
    print("tentacle.mesh")
    if folders:
        (HERE / "poses.csv").write_text(poses(folders[0]))
        print("poses.csv")
    if folders and (folders[0] / "two_tendons.csv").exists():
        (HERE / "both_tendons.csv").write_text(both_tendons(folders[0]))
        print("both_tendons.csv")
