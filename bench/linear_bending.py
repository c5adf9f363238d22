#!/usr/bin/env python3
"""By how much linear tetrahedra bend whose strains are averaged over neighbours, and what their factor costs.

Small strains. Compliances are over those of elements of order 2 on the same mesh; entries and operations of a sparse
factor are over those of plain linear elements. Needs NumPy, SciPy and softkin's Python package.

source  Dohrmann, Heinstein, Jung, Key, Witkowski 2000 (strains averaged at nodes); Liu, Nguyen-Thoi, Lam 2009 (at edges)
"""

import itertools
import pathlib

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as linalg

from softkin.mesh.msh_read import read_msh

FINGER = pathlib.Path(__file__).parent.parent / "examples/pneumatic_finger/pneumatic_finger.msh"
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]
SHARED = {"plain": 4, "faces": 3, "edges": 2, "nodes": 1}  # corners of an element that its patches share
MIXES = (0.5, 0.75)  # of averages at nodes, the rest at edges


def slopes(vertices, elements):
    """Of linear shape functions, (n, 4, 3), and volumes."""
    edges = (vertices[elements][:, 1:] - vertices[elements][:, :1]).transpose(0, 2, 1)
    inverse = np.linalg.inv(edges)
    return np.concatenate([-inverse.sum(1, keepdims=True), inverse], 1), np.linalg.det(edges) / 6


def strains(slope, elements, count):
    """From displacements to six strains of each element."""
    rows, columns, values = [], [], []
    each = np.arange(len(elements))
    for node in range(elements.shape[1]):
        x, y, z = slope[:, node].T
        for row, axis, value in [(0, 0, x), (1, 1, y), (2, 2, z), (3, 0, y), (3, 1, x), (4, 1, z), (4, 2, y),
                                 (5, 0, z), (5, 2, x)]:
            rows.append(6 * each + row)
            columns.append(3 * elements[:, node] + axis)
            values.append(value)
    parts = [np.concatenate(part) for part in (values, rows, columns)]
    return sp.csr_matrix((parts[0], (parts[1], parts[2])), (6 * len(elements), 3 * count))


def law(nu):
    """Of E = 1: of the change of shape, and of the volume."""
    shear, bulk = 0.5 / (1 + nu), 1 / (3 * (1 - 2 * nu))
    shape = np.diag([2 * shear] * 3 + [shear] * 3)
    shape[:3, :3] -= 2 / 3 * shear
    volume = np.zeros((6, 6))
    volume[:3, :3] = bulk
    return shape, volume


class Body:
    """A mesh of linear elements, and its stiffnesses."""

    def __init__(self, vertices, elements):
        self.vertices, self.elements = vertices, elements
        self.slope, self.volumes = slopes(vertices, elements)
        self.strains = strains(self.slope, elements, len(vertices))

    def averaged(self, corners, stiffness):
        """Of strains that are averaged over the elements around so many corners."""
        patches, rows, columns, weights = {}, [], [], []
        combinations = list(itertools.combinations(range(4), corners))
        for part in combinations:
            for element, key in enumerate(map(tuple, np.sort(self.elements[:, part], 1))):
                rows.append(patches.setdefault(key, len(patches)))
                columns.append(element)
                weights.append(self.volumes[element] / len(combinations))
        sums = sp.csr_matrix((weights, (rows, columns)), (len(patches), len(self.elements)))
        volumes = np.asarray(sums.sum(1)).ravel()
        means = sp.kron(sp.diags(1 / volumes) @ sums, sp.identity(6)) @ self.strains
        return means.T @ sp.kron(sp.diags(volumes), stiffness) @ means

    def raised(self, stiffness):
        """Of order 2: the stiffness, all nodes, and the node of each edge."""
        places, nodes = list(self.vertices), {}
        elements = np.zeros((len(self.elements), 10), int)
        elements[:, :4] = self.elements
        for element, corners in enumerate(self.elements):
            for i, (a, b) in enumerate(EDGES):
                key = tuple(sorted((corners[a], corners[b])))
                if key not in nodes:
                    nodes[key] = len(places)
                    places.append((self.vertices[key[0]] + self.vertices[key[1]]) / 2)
                elements[element, 4 + i] = nodes[key]
        total = 0
        for point in range(4):
            at = np.full(4, 0.1381966011250105)
            at[point] = 0.5854101966249685
            slope = np.empty((len(elements), 10, 3))
            for a in range(4):
                slope[:, a] = (4 * at[a] - 1) * self.slope[:, a]
            for i, (a, b) in enumerate(EDGES):
                slope[:, 4 + i] = 4 * (at[a] * self.slope[:, b] + at[b] * self.slope[:, a])
            own = strains(slope, elements, len(places))
            total = total + own.T @ sp.kron(sp.diags(self.volumes / 4), stiffness) @ own
        return total, np.array(places), nodes


def compliance(stiffness, free, force):
    """Work of the force, entries of the factor, and its operations."""
    unknowns = np.repeat(free, 3)
    factor = linalg.splu(sp.csc_matrix(stiffness)[unknowns][:, unknowns].tocsc(), permc_spec="MMD_AT_PLUS_A",
                         diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    own = force.ravel()[unknowns]
    return own @ factor.solve(own), factor.L.nnz, np.sum(np.diff(factor.L.indptr).astype(float) ** 2)


def show(name, body, nu, held, force, raised_force):
    """One line for each way to average. raised_force: from the nodes of edges to the forces of order 2."""
    shape, volume = law(nu)
    used = np.zeros(len(body.vertices), bool)
    used[body.elements.ravel()] = True
    free = used & ~held(body.vertices)
    stiffness, places, nodes = body.raised(shape + volume)
    used = np.concatenate([used, np.ones(len(places) - len(used), bool)])
    right, entries, operations = compliance(stiffness, used & ~held(places), raised_force(places, nodes))
    ways = {way: body.averaged(corners, shape + volume) for way, corners in SHARED.items()}
    for share in MIXES:
        ways[f"{share} nodes + {1 - share} edges"] = (body.averaged(1, share * shape + volume)
                                                      + body.averaged(2, (1 - share) * shape))
    found = {way: compliance(stiffness, free, force) for way, stiffness in ways.items()}
    plain = found["plain"]
    print(f"{name}, Poisson's ratio {nu}")
    for way, (work, own, done) in [*found.items(), ("order 2", (right, entries, operations))]:
        print(f"  {way:26s} bends {work / right:5.2f}  entries {own / plain[1]:5.1f}  "
              f"operations {done / plain[2]:6.1f}")


def bar(length, cells):
    """Of height 1 mm, with one layer of bricks, each of six tetrahedra."""
    sides = [np.linspace(0, length, cells + 1), np.linspace(0, 4, max(1, round(4 * cells / length)) + 1),
             np.array([0.0, 1.0])]
    counts = [len(side) for side in sides]
    vertices = np.array(list(itertools.product(*sides)))
    elements = []
    for cell in itertools.product(*(range(count - 1) for count in counts)):
        corner = {bits: np.ravel_multi_index(np.add(cell, bits), counts)
                  for bits in itertools.product((0, 1), repeat=3)}
        for order in itertools.permutations(range(3)):
            path = [np.zeros(3, int)]
            for axis in order:
                path.append(path[-1] + np.eye(3, dtype=int)[axis])
            elements.append([corner[tuple(bits)] for bits in path])
    elements = np.array(elements)
    turned = slopes(vertices, elements)[1] < 0
    elements[turned] = elements[turned][:, [0, 1, 3, 2]]
    return Body(vertices, elements)


def bend_bar(nu, cells):
    body = bar(40, cells)
    end = body.vertices[:, 0] > 40 - 1e-9
    force = np.zeros_like(body.vertices)
    force[end, 2] = 1 / end.sum()

    def raised(places, nodes):
        return np.concatenate([force, np.zeros((len(nodes), 3))])

    show(f"a bar of one layer, elements {40 // cells} times as long as it is thick", body, nu,
         lambda places: places[:, 0] < 1e-9, force, raised)


def bend_finger(nu):
    mesh = read_msh(FINGER)
    body = Body(mesh.vertices, mesh.tetrahedra[mesh.volume_regions["body"]])
    chamber = mesh.tetrahedra[mesh.volume_regions["chamber"]]
    slope, volumes = slopes(mesh.vertices, chamber)
    force = np.zeros_like(mesh.vertices)  # derivative of the chamber's volume
    for corner in range(4):
        np.add.at(force, chamber[:, corner], slope[:, corner] * volumes[:, None])
    faces = {}
    for element in chamber:
        for out in range(4):
            face = tuple(sorted(np.delete(element, out)))
            faces[face] = None if face in faces else element[out]

    def raised(places, nodes):
        forces = np.zeros_like(places)
        for face, behind in faces.items():
            if behind is None:
                continue
            a, b, c = (mesh.vertices[v] for v in face)
            area = np.cross(b - a, c - a) / 2
            area *= np.sign(area @ (a - mesh.vertices[behind]))
            for pair in itertools.combinations(face, 2):
                forces[nodes[pair]] += area / 3
        return forces

    show("examples/pneumatic_finger, walls of one element", body, nu, lambda places: places[:, 0] < 1e-6, force, raised)


def main():
    for nu in (0.3, 0.45):
        bend_finger(nu)
        for cells in (40, 20, 10):
            bend_bar(nu, cells)


if __name__ == "__main__":
    main()
