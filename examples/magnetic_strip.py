#!/usr/bin/env python3
"""Writes the strip of which the magnetic examples are made, as Gmsh 2.2: cells of six tetrahedra each, x along it.

magnetic_strip.py --size 17.2 5 0.84 --cells 24 4 1 -o magnetic_cantilever/magnetic_cantilever.msh
magnetic_strip.py --size 30 6 0.8 --cells 20 2 1 --arch 6 -o magnetic_crawler/magnetic_crawler.msh

Volumes `rear` and `front` are its halves, surfaces `base` and `tip` its ends. --arch raises the middle by so much [mm].
"""

import argparse
import itertools


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=float, nargs=3, required=True, help="length, width, thickness [mm]")
    parser.add_argument("--cells", type=int, nargs=3, required=True, help="along each of them")
    parser.add_argument("--arch", type=float, default=0, help="[mm]")
    parser.add_argument("-o", "--output", required=True)
    args = parser.parse_args()
    nx, ny, nz = args.cells

    def number(i: int, j: int, k: int) -> int:
        return 1 + i + (nx + 1) * (j + (ny + 1) * k)

    nodes = []
    for k, j, i in itertools.product(range(nz + 1), range(ny + 1), range(nx + 1)):
        x, y, z = (length * at / count for length, at, count in zip(args.size, (i, j, k), args.cells))
        z += args.arch * (1 - (2 * i / nx - 1) ** 2)
        nodes.append(f"{len(nodes) + 1} {x:.10g} {y:.10g} {z:.10g}")

    # group, type and nodes; of every way along three edges from the first corner of a cell to the last, a tetrahedron
    elements = []
    for k, j, i in itertools.product(range(nz), range(ny), range(nx)):
        for order in itertools.permutations(range(3)):
            corner, way = [i, j, k], [number(i, j, k)]
            for axis in order:
                corner[axis] += 1
                way.append(number(*corner))
            if order in ((1, 0, 2), (0, 2, 1), (2, 1, 0)):  # the others turn the right way
                way[1], way[2] = way[2], way[1]
            elements.append((1 if 2 * i < nx else 2, 4, way))
    for group, i in ((3, 0), (4, nx)):
        for k, j in itertools.product(range(nz), range(ny)):
            a, b, c, d = number(i, j, k), number(i, j + 1, k), number(i, j, k + 1), number(i, j + 1, k + 1)
            elements += [(group, 2, [a, b, d]), (group, 2, [a, d, c])]

    with open(args.output, "w", encoding="utf-8") as file:
        file.write('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n3 1 "rear"\n3 2 "front"\n2 3 "base"\n')
        file.write(f'2 4 "tip"\n$EndPhysicalNames\n$Nodes\n{len(nodes)}\n' + "\n".join(nodes) + "\n$EndNodes\n")
        file.write(f"$Elements\n{len(elements)}\n")
        for at, (group, kind, way) in enumerate(elements):
            file.write(f"{at + 1} {kind} 2 {group} {group} {' '.join(map(str, way))}\n")
        file.write("$EndElements\n")


main()
