"""Makes the mesh of the beam, and the table of its measured poses.

    python3 make_beam.py [FOLDER]

FOLDER holds gravity.csv and load_52g.csv as measured (README.md says where they come from); without it the mesh alone is
made.
"""

import csv
import math
import sys
from pathlib import Path

HERE = Path(__file__).parent
CELLS, SIZE_MM = (14, 4, 4), (100.0, 30.0, 30.0)
# where the markers stand in the beam's frame at rest, about [mm]: on stems on its end and beside its clamp
TIPS = {"tip1": (0, 15, 36), "tip2": (0, -6, 24), "tip3": (0, 36, 6)}
BASES = {"base1": (-94, -10, -1), "base2": (-94, 40, 27.5), "base3": (-94, 40, 0)}
FIRST_S, LAST_S = 0.3, 0.5  # held straight before it is let go; at rest in the end [s]


def mesh() -> str:
    """Bricks of six tetrahedra each, the clamped face at x = -100, the free one at x = 0."""
    nx, ny, nz = CELLS
    vertices = [(SIZE_MM[0] * (i / nx - 1), SIZE_MM[1] * j / ny, SIZE_MM[2] * k / nz) for i in range(nx + 1) for j in range(ny + 1) for k in range(nz + 1)]

    def vertex(i: int, j: int, k: int) -> int:
        return (i * (ny + 1) + j) * (nz + 1) + k + 1

    tetrahedra = []
    for i in range(nx):
        for j in range(ny):
            for k in range(nz):
                for way in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (1, 0, 2), (2, 1, 0)):
                    at, corners = [i, j, k], [vertex(i, j, k)]
                    for axis in way:
                        at[axis] += 1
                        corners.append(vertex(*at))
                    if way in ((0, 2, 1), (1, 0, 2), (2, 1, 0)):
                        corners[2], corners[3] = corners[3], corners[2]
                    tetrahedra.append(corners)
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(vertices))]
    lines += ["%.6f %.6f %.6f 0" % v for v in vertices]
    lines += ["Tetrahedra", str(len(tetrahedra))]
    lines += ["%d %d %d %d 1" % tuple(t) for t in tetrahedra]
    return "\n".join([*lines, "End", ""])


Vector = tuple[float, float, float]


def turned(q: list[float], v: Vector) -> Vector:
    """By a unit quaternion."""
    w, x, y, z = q
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return (v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0])


def rotation_onto(points: list[Vector], targets: list[Vector]) -> list[float]:
    """The quaternion that turns points best onto targets, both about their means (Horn 1987), by powers of his matrix."""

    def centred(all_points: list[Vector]) -> list[Vector]:
        mean = [sum(p[a] for p in all_points) / len(all_points) for a in range(3)]
        return [(p[0] - mean[0], p[1] - mean[1], p[2] - mean[2]) for p in all_points]

    s = [[sum(p[a] * t[b] for p, t in zip(centred(points), centred(targets))) for b in range(3)] for a in range(3)]
    n = [
        [s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]],
        [s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]],
        [s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]],
        [s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]],
    ]
    shift = sum(abs(value) for row in n for value in row)  # makes the largest eigenvalue the one of largest size
    q = [0.4, 0.5, 0.6, 0.7]
    for _ in range(2000):
        q = [sum(n[i][j] * q[j] for j in range(4)) + shift * q[i] for i in range(4)]
        size = math.sqrt(sum(value * value for value in q))
        q = [value / size for value in q]
    return q


def settled(file: Path) -> dict[str, Vector]:
    """Where the markers come to rest, in the beam's frame: from where they stand about, and by how they move [mm]."""
    with open(file, newline="") as stream:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(line for line in stream if not line.startswith("#"))]
    last = rows[-1]["t_s"]

    def mean(name: str, some: list[dict[str, float]]) -> Vector:
        x, y, z = (sum(row[f"{name}_{axis}_mm"] for row in some) / len(some) for axis in "xyz")
        return (x, y, z)

    stand = {**TIPS, **BASES}
    begin = {name: mean(name, [row for row in rows if row["t_s"] <= FIRST_S]) for name in stand}
    end = {name: mean(name, [row for row in rows if row["t_s"] >= last - LAST_S]) for name in stand}
    q = rotation_onto(list(begin.values()), list(stand.values()))
    places = {}
    for name, at in stand.items():
        moved = turned(q, (end[name][0] - begin[name][0], end[name][1] - begin[name][1], end[name][2] - begin[name][2]))
        places[name] = (at[0] + moved[0], at[1] + moved[1], at[2] + moved[2])
    slip = max(math.dist(places[name], BASES[name]) for name in BASES)
    print(f"{file.name}: the markers beside the clamp move by {slip:.2f} mm at most")
    return places


def poses(folder: Path) -> list[list[str]]:
    """The header, a row for the beam under its weight, and one for that which bears 52 g, 100 mm to its side."""
    header: list[str] = []
    rows: list[list[str]] = []
    for beam, file, aside in (("free", "gravity.csv", 0), ("loaded", "load_52g.csv", 100)):
        places, cells = settled(folder / file), []
        for marker in TIPS:
            header += [f"{beam}_{marker}_{axis}_mm" for axis in "xyz"]
            cells += [f"{place + shift:.3f}" for place, shift in zip(places[marker], (0, aside, 0))]
        rows.append(cells)
    empty = [""] * len(rows[0])
    return [header, rows[0] + empty, empty + rows[1]]


def at_once(poses: list[list[str]]) -> list[list[str]]:
    """Both beams in one row: what is told of one tells of the other."""
    header, free, loaded = poses
    return [header, [a or b for a, b in zip(free, loaded)]]


def table(rows: list[list[str]]) -> str:
    return "\n".join(",".join(cells) for cells in rows) + "\n"


if __name__ == "__main__":
    (HERE / "beam.mesh").write_text(mesh())
    print("beam.mesh")
    if len(sys.argv) > 1:
        measured = poses(Path(sys.argv[1]))
        for name, rows in (("poses.csv", measured), ("at_once.csv", at_once(measured))):
            (HERE / name).write_text(table(rows))
            print(name)
