#!/usr/bin/env python3
"""Compares the bending compliance and the factor of linear tetrahedra whose strains are averaged over neighbours.

Strains are small. The script prints compliances over those of elements of order 2 on the same mesh, and the entries
and operations of a sparse factor over those of plain linear elements. It needs NumPy, SciPy and softkin's Python
package.

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
PATCH_CORNERS = {"plain": 4, "faces": 3, "edges": 2, "nodes": 1}  # common corners of the elements of a patch
NODE_FRACTIONS = (0.5, 0.75)  # of averages at nodes; the rest is averaged at edges


def shape_gradients(vertices, elements):
    """Returns the gradients of linear shape functions, (n, 4, 3), and the volumes."""
    edges = (vertices[elements][:, 1:] - vertices[elements][:, :1]).transpose(0, 2, 1)
    inverse = np.linalg.inv(edges)
    return np.concatenate([-inverse.sum(1, keepdims=True), inverse], 1), np.linalg.det(edges) / 6


def strain_operator(gradients, elements, count):
    """Returns the matrix from displacements to the six strains of each element."""
    rows, columns, values = [], [], []
    each = np.arange(len(elements))
    for node in range(elements.shape[1]):
        x, y, z = gradients[:, node].T
        for row, axis, value in [(0, 0, x), (1, 1, y), (2, 2, z), (3, 0, y), (3, 1, x), (4, 1, z), (4, 2, y),
                                 (5, 0, z), (5, 2, x)]:
            rows.append(6 * each + row)
            columns.append(3 * elements[:, node] + axis)
            values.append(value)
    parts = [np.concatenate(part) for part in (values, rows, columns)]
    return sp.csr_matrix((parts[0], (parts[1], parts[2])), (6 * len(elements), 3 * count))


def law(nu):
    """Returns the deviatoric and the volumetric stiffness of a material with E = 1."""
    shear, bulk = 0.5 / (1 + nu), 1 / (3 * (1 - 2 * nu))
    deviatoric = np.diag([2 * shear] * 3 + [shear] * 3)
    deviatoric[:3, :3] -= 2 / 3 * shear
    volumetric = np.zeros((6, 6))
    volumetric[:3, :3] = bulk
    return deviatoric, volumetric


class Body:
    """A mesh of linear elements, and its stiffness matrices."""

    def __init__(self, vertices, elements):
        self.vertices, self.elements = vertices, elements
        self.gradients, self.volumes = shape_gradients(vertices, elements)
        self.strains = strain_operator(self.gradients, elements, len(vertices))

    def averaged_stiffness(self, corners, stiffness):
        """Returns the stiffness matrix of strains that are averaged over elements with `corners` common corners."""
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

    def quadratic_stiffness(self, stiffness):
        """Returns the stiffness matrix of elements of order 2, their nodes, and the node of each edge."""
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
            barycentric = np.full(4, 0.1381966011250105)
            barycentric[point] = 0.5854101966249685
            gradients = np.empty((len(elements), 10, 3))
            for a in range(4):
                gradients[:, a] = (4 * barycentric[a] - 1) * self.gradients[:, a]
            for i, (a, b) in enumerate(EDGES):
                gradients[:, 4 + i] = 4 * (barycentric[a] * self.gradients[:, b]
                                           + barycentric[b] * self.gradients[:, a])
            own = strain_operator(gradients, elements, len(places))
            total = total + own.T @ sp.kron(sp.diags(self.volumes / 4), stiffness) @ own
        return total, np.array(places), nodes


def compliance(stiffness, free, force):
    """Returns the work of the force, and the entries and operations of the factor."""
    unknowns = np.repeat(free, 3)
    factor = linalg.splu(sp.csc_matrix(stiffness)[unknowns][:, unknowns].tocsc(), permc_spec="MMD_AT_PLUS_A",
                         diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    own = force.ravel()[unknowns]
    return own @ factor.solve(own), factor.L.nnz, np.sum(np.diff(factor.L.indptr).astype(float) ** 2)


def show(name, body, nu, is_fixed, force, quadratic_force):
    """Prints one line for each average. quadratic_force returns the forces of order 2 from the nodes of edges."""
    deviatoric, volumetric = law(nu)
    used = np.zeros(len(body.vertices), bool)
    used[body.elements.ravel()] = True
    free = used & ~is_fixed(body.vertices)
    stiffness, places, nodes = body.quadratic_stiffness(deviatoric + volumetric)
    used = np.concatenate([used, np.ones(len(places) - len(used), bool)])
    reference, entries, operations = compliance(stiffness, used & ~is_fixed(places), quadratic_force(places, nodes))
    averages = {average: body.averaged_stiffness(corners, deviatoric + volumetric)
                for average, corners in PATCH_CORNERS.items()}
    for fraction in NODE_FRACTIONS:
        averages[f"{fraction} nodes + {1 - fraction} edges"] = (
            body.averaged_stiffness(1, fraction * deviatoric + volumetric)
            + body.averaged_stiffness(2, (1 - fraction) * deviatoric))
    found = {average: compliance(stiffness, free, force) for average, stiffness in averages.items()}
    plain = found["plain"]
    print(f"{name}, Poisson's ratio {nu}")
    for average, (work, own_entries, own_operations) in [*found.items(),
                                                         ("order 2", (reference, entries, operations))]:
        print(f"  {average:26s} bends {work / reference:5.2f}  entries {own_entries / plain[1]:5.1f}  "
              f"operations {own_operations / plain[2]:6.1f}")


def bar(length, cells):
    """Returns a bar of height 1 mm, with one layer of bricks, each of six tetrahedra."""
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
    inverted = shape_gradients(vertices, elements)[1] < 0
    elements[inverted] = elements[inverted][:, [0, 1, 3, 2]]
    return Body(vertices, elements)


def bend_bar(nu, cells):
    """Bends a bar by a force at its end."""
    body = bar(40, cells)
    end = body.vertices[:, 0] > 40 - 1e-9
    force = np.zeros_like(body.vertices)
    force[end, 2] = 1 / end.sum()

    def quadratic_force(places, nodes):
        return np.concatenate([force, np.zeros((len(nodes), 3))])

    show(f"a bar of one layer, elements {40 // cells} times as long as it is thick", body, nu,
         lambda places: places[:, 0] < 1e-9, force, quadratic_force)


def bend_finger(nu):
    """Bends the finger of the examples by a pressure."""
    mesh = read_msh(FINGER)
    body = Body(mesh.vertices, mesh.tetrahedra[mesh.volume_regions["body"]])
    chamber = mesh.tetrahedra[mesh.volume_regions["chamber"]]
    gradients, volumes = shape_gradients(mesh.vertices, chamber)
    force = np.zeros_like(mesh.vertices)  # derivative of the chamber's volume
    for corner in range(4):
        np.add.at(force, chamber[:, corner], gradients[:, corner] * volumes[:, None])
    faces = {}
    for element in chamber:
        for out in range(4):
            face = tuple(sorted(np.delete(element, out)))
            faces[face] = None if face in faces else element[out]

    def quadratic_force(places, nodes):
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

    show("examples/pneumatic_finger, walls of one element", body, nu, lambda places: places[:, 0] < 1e-6, force,
         quadratic_force)


def main():
    for nu in (0.3, 0.45):
        bend_finger(nu)
        for cells in (40, 20, 10):
            bend_bar(nu, cells)


if __name__ == "__main__":
    main()
