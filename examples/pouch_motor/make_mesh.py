"""Writes pouch_motor.msh: two sheets of film welded along their rim, with a tab of film at either end.

    python3 make_mesh.py [--cells 12]
"""

import argparse
from pathlib import Path

LENGTH, WIDTH, TAB = 40.0, 60.0, 6.0  # mm: of the pouch along x and y, and of the tabs along x


class Sheets:
    """Vertices and triangles of rectangles in the plane z = 0."""

    def __init__(self):
        self.points, self.triangles = [], {}

    def add(self, name, x, y, known):
        """A rectangle of cells between the lines x and y; vertices that `known` has are shared."""
        numbers = {}
        for j, v in enumerate(y):
            for i, u in enumerate(x):
                if (u, v) not in known:
                    known[u, v] = len(self.points)
                    self.points.append((u, v, 0.0))
                numbers[i, j] = known[u, v]
        cells = self.triangles.setdefault(name, [])
        for j in range(len(y) - 1):
            for i in range(len(x) - 1):
                a, b = numbers[i, j], numbers[i + 1, j]
                c, d = numbers[i + 1, j + 1], numbers[i, j + 1]
                # diagonals run into the corners, so that no triangle lies in the rim alone
                if (2 * i < len(x) - 1) == (2 * j < len(y) - 1):
                    cells += [(a, b, c), (a, c, d)]
                else:
                    cells += [(a, b, d), (b, c, d)]


def spaced(low, high, cells):
    return [low + (high - low) * i / cells for i in range(cells + 1)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", type=int, default=12, help="along the pouch (default: 12)")
    cells = parser.parse_args().cells
    x, y = spaced(-LENGTH / 2, LENGTH / 2, cells), spaced(-WIDTH / 2, WIDTH / 2, round(cells * WIDTH / LENGTH))
    sheets = Sheets()
    rim = {}
    sheets.add("top", x, y, rim)
    inside = {p for p in rim if p[0] in x[1:-1] and p[1] in y[1:-1]}
    middle = rim[min(inside, key=lambda p: p[0] ** 2 + p[1] ** 2)]
    rim = {p: v for p, v in rim.items() if p not in inside}
    sheets.add("bottom", x, y, rim)
    sheets.add("base", [x[0] - TAB, x[0] - TAB / 2, x[0]], y, rim)
    sheets.add("tab", [x[-1], x[-1] + TAB / 2, x[-1] + TAB], y, rim)
    groups = {"pouch": sheets.triangles["top"] + sheets.triangles["bottom"],
              "base": sheets.triangles["base"], "tab": sheets.triangles["tab"]}
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(groups) + 1)]
    lines += [f'2 {tag} "{name}"' for tag, name in enumerate(groups, 1)] + ['0 9 "middle"', "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(sheets.points))]
    lines += [f"{i} {p[0]:.9g} {p[1]:.9g} {p[2]:.9g}" for i, p in enumerate(sheets.points, 1)]
    elements = [f"15 2 9 9 {middle + 1}"]
    for tag, name in enumerate(groups, 1):
        elements += [f"2 2 {tag} {tag} " + " ".join(str(v + 1) for v in t) for t in groups[name]]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{i} {e}" for i, e in enumerate(elements, 1)] + ["$EndElements", ""]
    Path(__file__).with_name("pouch_motor.msh").write_text("\n".join(lines))


if __name__ == "__main__":
    main()
