#!/usr/bin/env python3
"""How the tip of three robots of target shapes depends on the mesh, by the printed and by mesh-independent weights.

Each robot of the examples is bent with its own mesh, with one whose edges are shorter everywhere, and with one whose
edges are shorter in one half alone: there the printed weights make the material softer than in the other half. Needs
Python alone.
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
CORNERS = {15: 1, 1: 2, 2: 3, 4: 4}  # of Gmsh's kinds of elements


def sections(text):
    """Name and lines of each section of a .msh."""
    name, lines = "", []
    for line in text.splitlines():
        if line.startswith("$End"):
            yield name, lines
        elif line.startswith("$"):
            name, lines = line[1:], []
        else:
            lines.append(line.split())


class Mesh:
    """Vertices, and elements as (kind, physical group, vertices)."""

    def __init__(self, text):
        parts = dict(sections(text))
        self.names = [" ".join(words) for words in parts["PhysicalNames"][1:]]
        groups = self.groups(parts["Entities"])
        self.vertices, number_of, at = [], {}, iter(parts["Nodes"][1:])
        for block in at:
            tags = [next(at)[0] for _ in range(int(block[3]))]
            for tag in tags:
                number_of[tag] = len(self.vertices)
                self.vertices.append(tuple(map(float, next(at))))
        self.elements, at = [], iter(parts["Elements"][1:])
        for dimension, entity, kind, count in at:
            for _ in range(int(count)):
                nodes = tuple(number_of[tag] for tag in next(at)[1:])
                for group in groups.get((dimension, entity), [0]):
                    self.elements.append((int(kind), group, nodes))

    @staticmethod
    def groups(lines):
        """Physical groups by dimension and tag of the entity."""
        found, at = {}, iter(lines)
        counts = list(map(int, next(at)))
        for dimension, count in enumerate(counts):
            first = 4 if dimension == 0 else 7
            for _ in range(count):
                words = next(at)
                found[str(dimension), words[0]] = words[first + 1:first + 1 + int(words[first])] or [0]
        return found

    def middle(self, edge):
        return tuple(0.5 * (a + b) for a, b in zip(*(self.vertices[v] for v in edge)))

    def refine(self, longest_at):
        """Halves edges until none is longer than longest_at(its middle) [mm], each after the longer ones of the elements
        around it, so that these keep their quality (Rivara's longest-edge bisection)."""
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
                    if length(edge)[0] > longest_at(self.middle(edge)):
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
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(self.names)), *self.names,
                 "$EndPhysicalNames", "$Nodes", str(len(self.vertices))]
        lines += [f"{n} {x!r} {y!r} {z!r}" for n, (x, y, z) in enumerate(self.vertices, 1)]
        lines += ["$EndNodes", "$Elements", str(len(self.elements))]
        lines += [f"{n} {kind} 2 {group} 1 " + " ".join(str(v + 1) for v in nodes)
                  for n, (kind, group, nodes) in enumerate(self.elements, 1)]
        return "\n".join([*lines, "$EndElements", ""])


def meshes(program, shipped, axis, share, folder):
    """Name and file of each mesh: as shipped, finer all over, finer in the outer half."""
    written = folder / f"{shipped.stem}.msh"
    subprocess.run([program, "mesh", "convert", shipped, written, "--ascii", "--force-overwrite"], check=True,
                   stdout=subprocess.DEVNULL)
    text = written.read_text()
    places = [vertex[axis] for vertex in Mesh(text).vertices]
    half = 0.5 * (min(places) + max(places))

    def typical():
        mesh = Mesh(text)
        lengths = sorted(math.dist(mesh.vertices[a], mesh.vertices[b])
                         for kind, _, nodes in mesh.elements if kind == 4 for a in nodes for b in nodes if a < b)
        return lengths[len(lengths) // 2]

    fine = share * typical()
    yield "as shipped", written
    for name, longest_at in (("finer all over", lambda _: fine),
                             ("finer in the outer half", lambda at: fine if at[axis] > half else math.inf)):
        mesh = Mesh(text)
        mesh.refine(longest_at)
        file = folder / f"{shipped.stem}_{name.replace(' ', '_')}.msh"
        file.write_text(mesh.text())
        yield name, file


def solve(program, scene, mesh, weights, commands, changes, threads):
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
    parser.add_argument("--share", type=float, default=1.2,
                        help="longest edge of finer meshes over the median of the shipped one (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=0)
    asked = parser.parse_args()
    examples = pathlib.Path(__file__).resolve().parent.parent / "examples"
    print(f"{'robot':18}{'mesh':26}{'tetrahedra':>10}" + "".join(
        f"   {weights + ': tip x, y, z [mm]':>38}{'off [mm]':>10}" for weights in WEIGHTS))
    bad = False
    with tempfile.TemporaryDirectory() as folder:
        for robot in asked.robots:
            name, axis, commands, changes = ROBOTS[robot]
            scene = examples / name / f"{name}.yaml"
            rows = []
            for mesh, file in meshes(asked.softkin, scene.with_suffix(".msh"), axis, asked.share, pathlib.Path(folder)):
                found = [solve(asked.softkin, scene, file, w, commands, changes, asked.threads) for w in WEIGHTS]
                bad = bad or any(step["status"] != "converged" for _, step in found)
                rows.append((mesh, found[0][0], [step["markers"]["tip"] for _, step in found]))
            finest = rows[1][2]
            for mesh, count, tips in rows:
                print(f"{robot:18}{mesh:26}{count:10}" + "".join(
                    f"   {', '.join(f'{x:.2f}' for x in tip):>38}{math.dist(tip, best):10.2f}"
                    for tip, best in zip(tips, finest)), flush=True)
    if bad:
        sys.exit("weights_study: not all of them converged")


if __name__ == "__main__":
    main()
