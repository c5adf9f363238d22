"""Writes a robot for thousands of solves: a bar of 12 tetrahedra with two tendons, or one that walks."""

import itertools
import math


def bar(cells=2, edge=10):
    """Returns a row of cubes of six tetrahedra each as Gmsh 2.2 text, with the groups body, base and tip."""
    def vertex(i, j, k):
        return 1 + i + (cells + 1) * (j + 2 * k)

    elements = []
    for i in range(cells):
        corners = [vertex(i + (c & 1), c >> 1 & 1, c >> 2) for c in range(8)]
        elements += [(4, 1, (corners[0], corners[a], corners[b], corners[7])) for a,
                     b in ((1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1))]
    for i, group in ((0, 2), (cells, 3)):
        a, b, c, d = vertex(i, 0, 0), vertex(i, 1, 0), vertex(i, 1, 1), vertex(i, 0, 1)
        elements += [(2, group, (a, b, c)), (2, group, (a, c, d))]
    places = sorted((k, j, i) for i, j, k in itertools.product(range(cells + 1), range(2), range(2)))
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", "3", '3 1 "body"', '2 2 "base"',
             '2 3 "tip"', "$EndPhysicalNames", "$Nodes", str(len(places))]
    lines += [f"{n} {edge * i} {edge * j} {edge * k}" for n, (k, j, i) in enumerate(places, 1)]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{n} {kind} 2 {group} 1 " + " ".join(map(str, of)) for n, (kind, group, of) in enumerate(elements, 1)]
    return "\n".join(lines + ["$EndElements", ""])


RUBBER = "softkin: 1\nmesh: {file: bar.msh}\nmaterials: [{youngs_modulus: 1, poisson_ratio: 0.3}]\n"
BENDING = RUBBER + """fixed: [{region: base}]
actuators:
  - {name: upper, kind: cable, points: [[0, 5, 10], [20, 5, 10]], control: length, range: [0.7, 1.2]}
  - {name: lower, kind: cable, points: [[0, 5, 0], [20, 5, 0]], control: length, range: [0.7, 1.2]}
markers: [{name: tip, region: tip}]
"""
WALKING = RUBBER + """fixed: [{region: base}, {region: tip, axes: yz}]
actuators: [{name: tendon, kind: cable, points: [[0, 5, 5], [20, 5, 5]], control: tension, range: [0, 5]}]
markers: [{name: heel, region: base}, {name: toe, region: tip}]
feet: [{marker: heel, forward: 0.02, backward: 9}, {marker: toe, forward: 0.02, backward: 9}]
"""
GAIT = "t_s,tendon_N\n0,0\n0.5,1\n1,2\n1.5,1\n2,0\n"


def path(rows):
    """Returns commands of both tendons along a curve that does not repeat."""
    lines = ["upper,lower"]
    for i in range(rows):
        lines.append(f"{0.9 + 0.08 * math.cos(0.11 * i):.12g},{0.92 + 0.07 * math.sin(0.17 * i):.12g}")
    return "\n".join(lines) + "\n"


def write(folder, rows):
    """Writes the mesh, the scenes and the tables into a folder."""
    for name, text in (("bar.msh", bar()), ("bend.yaml", BENDING), ("walk.yaml", WALKING), ("gait.csv", GAIT),
                       ("path.csv", path(rows))):
        (folder / name).write_text(text)
