#!/usr/bin/env python3
"""Measures the dependence of three robots of target shapes on the mesh, with printed and mesh-independent weights.

The script bends each robot with its own mesh, with one whose edges are shorter everywhere, and with one whose edges
are shorter in one half alone: there the printed weights make the material softer than in the other half. It needs only
Python.
"""

import argparse
import heapq
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROBOTS = {  # scene, axis along it, commands, other changes of the scene
    "pneumatic finger": ("pneumatic_finger", 0, ["air=1.4"], ["--formulation", "target-shape"]),
    "three chambers": ("three_chamber_actuator", 2, ["air1=1.3"], ["--formulation", "target-shape"]),
    "cable gripper": ("cable_gripper", 0, ["cable=0.8"], ["--formulation", "target-shape"]),
}
WEIGHTS = ("printed", "mesh-independent")
CORNERS = {15: 1, 1: 2, 2: 3, 4: 4}  # number of corners by Gmsh's type of element


def sections(text):
    """Yields the name and the lines of each section of a .msh."""
    name, lines = "", []
    for line in text.splitlines():
        if line.startswith("$End"):
            yield name, lines
        elif line.startswith("$"):
            name, lines = line[1:], []
        else:
            lines.append(line.split())


class Mesh:
    """A mesh: vertices, and elements as (kind, physical group, vertices)."""

    def __init__(self, text):
        parts = dict(sections(text))
        self.names = [" ".join(words) for words in parts["PhysicalNames"][1:]]
        groups = self.groups(parts["Entities"])
        self.vertices, number_of, lines = [], {}, iter(parts["Nodes"][1:])
        for block in lines:
            tags = [next(lines)[0] for _ in range(int(block[3]))]
            for tag in tags:
                number_of[tag] = len(self.vertices)
                self.vertices.append(tuple(map(float, next(lines))))
        self.elements, lines = [], iter(parts["Elements"][1:])
        for dimension, entity, kind, count in lines:
            for _ in range(int(count)):
                nodes = tuple(number_of[tag] for tag in next(lines)[1:])
                for group in groups.get((dimension, entity), [0]):
                    self.elements.append((int(kind), group, nodes))

    @staticmethod
    def groups(lines):
        """Returns the physical groups by dimension and tag of the entity."""
        found, remaining = {}, iter(lines)
        counts = list(map(int, next(remaining)))
        for dimension, count in enumerate(counts):
            first = 4 if dimension == 0 else 7
            for _ in range(count):
                words = next(remaining)
                found[str(dimension), words[0]] = words[first + 1:first + 1 + int(words[first])] or [0]
        return found

    def middle(self, edge):
        """Returns the middle of an edge."""
        return tuple(0.5 * (a + b) for a, b in zip(*(self.vertices[v] for v in edge)))

    def refine(self, max_length_at):
        """Halves edges until none is longer than max_length_at(its middle) [mm], by Rivara's longest-edge bisection.

        An edge is halved after the longer edges of its elements, so that these keep their quality.
        """
        around, queue = {}, []

        def length(edge):
            return math.dist(self.vertices[edge[0]], self.vertices[edge[1]]), edge

        def edges(number):
            nodes = self.elements[number][2]
            return [(min(a, b), max(a, b)) for i, a in enumerate(nodes) for b in nodes[:i]]

        def add(number):
            for edge in edges(number):
                if edge not in around:
                    around[edge] = set()
                    if length(edge)[0] > max_length_at(self.middle(edge)):
                        heapq.heappush(queue, (-length(edge)[0], edge))
                around[edge].add(number)

        def halve(edge):
            new = len(self.vertices)
            self.vertices.append(self.middle(edge))
            for number in sorted(around[edge]):
                for each in edges(number):
                    if each != edge:
                        around[each].discard(number)
                kind, group, nodes = self.elements[number]
                self.elements[number], second = [
                    (kind, group, tuple(new if node == end else node for node in nodes)) for end in edge]
                self.elements.append(second)
                add(number)
                add(len(self.elements) - 1)
            del around[edge]

        for number in range(len(self.elements)):
            add(number)
        while queue:
            waiting = [heapq.heappop(queue)[1]]
            while waiting:
                edge = waiting[-1]
                longest = max((length(each) for number in around.get(edge, ()) for each in edges(number)), default=None)
                if longest is None or longest[1] == edge:
                    waiting.pop()
                    if longest:
                        halve(edge)
                else:
                    waiting.append(longest[1])

    def text(self):
        """Returns the mesh as a .msh of version 2.2 in ASCII."""
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(self.names)), *self.names,
                 "$EndPhysicalNames", "$Nodes", str(len(self.vertices))]
        lines += [f"{n} {x!r} {y!r} {z!r}" for n, (x, y, z) in enumerate(self.vertices, 1)]
        lines += ["$EndNodes", "$Elements", str(len(self.elements))]
        lines += [f"{n} {kind} 2 {group} 1 " + " ".join(str(v + 1) for v in nodes)
                  for n, (kind, group, nodes) in enumerate(self.elements, 1)]
        return "\n".join([*lines, "$EndElements", ""])


def meshes(program, shipped, axis, edge_ratio, folder):
    """Yields the name and the file of each mesh: as shipped, finer all over, finer in the outer half."""
    written = folder / f"{shipped.stem}.msh"
    subprocess.run([program, "mesh", "convert", shipped, written, "--ascii", "--force-overwrite"], check=True,
                   stdout=subprocess.DEVNULL)
    text = written.read_text()
    places = [vertex[axis] for vertex in Mesh(text).vertices]
    half = 0.5 * (min(places) + max(places))

    def median_length():
        mesh = Mesh(text)
        lengths = sorted(math.dist(mesh.vertices[a], mesh.vertices[b])
                         for kind, _, nodes in mesh.elements if kind == 4 for a in nodes for b in nodes if a < b)
        return lengths[len(lengths) // 2]

    fine = edge_ratio * median_length()
    yield "as shipped", written
    for name, max_length_at in (("finer all over", lambda _: fine),
                                ("finer in the outer half", lambda point: fine if point[axis] > half else math.inf)):
        mesh = Mesh(text)
        mesh.refine(max_length_at)
        file = folder / f"{shipped.stem}_{name.replace(' ', '_')}.msh"
        file.write_text(mesh.text())
        yield name, file


def solve(program, scene, mesh, weights, commands, changes, threads):
    """Returns the number of tetrahedra and the step of the report of fk."""
    words = [program, "fk", scene, *changes, "--change", f"mesh.file={mesh}", "--change", f"weights={weights}", "--json",
             "--threads", str(threads)]
    for command in commands:
        words += ["--set", command]
    run = subprocess.run(words, stdout=subprocess.PIPE, check=False)
    report = json.loads(run.stdout)
    return report["mesh"]["tetrahedra"], report["steps"][0]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--softkin", default="build/softkin", help="the program (default: %(default)s)")
    parser.add_argument("--robots", nargs="+", choices=list(ROBOTS), default=list(ROBOTS))
    parser.add_argument("--share", dest="edge_ratio", metavar="RATIO", type=float, default=1.2,
                        help="maximum edge of finer meshes over the median of the shipped one (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=0)
    options = parser.parse_args()
    examples = pathlib.Path(__file__).resolve().parent.parent / "examples"
    print(f"{'robot':18}{'mesh':26}{'tetrahedra':>10}" + "".join(
        f"   {weights + ': tip x, y, z [mm]':>38}{'off [mm]':>10}" for weights in WEIGHTS))
    any_failed = False
    with tempfile.TemporaryDirectory() as folder:
        for robot in options.robots:
            name, axis, commands, changes = ROBOTS[robot]
            scene = examples / name / f"{name}.yaml"
            rows = []
            for mesh, file in meshes(options.softkin, scene.with_suffix(".msh"), axis, options.edge_ratio,
                                     pathlib.Path(folder)):
                found = [solve(options.softkin, scene, file, w, commands, changes, options.threads) for w in WEIGHTS]
                any_failed = any_failed or any(step["status"] != "converged" for _, step in found)
                rows.append((mesh, found[0][0], [step["markers"]["tip"] for _, step in found]))
            finest = rows[1][2]
            for mesh, count, tips in rows:
                print(f"{robot:18}{mesh:26}{count:10}" + "".join(
                    f"   {', '.join(f'{x:.2f}' for x in tip):>38}{math.dist(tip, best):10.2f}"
                    for tip, best in zip(tips, finest)), flush=True)
    if any_failed:
        sys.exit("weights_study: not all solves converged")


if __name__ == "__main__":
    main()
