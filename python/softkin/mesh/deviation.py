"""The distance between the surface of a mesh and the given surface."""

from __future__ import annotations

import numpy as np

from .arrays import Array
from .distance import distances
from .surface import Surface
from .winding import winding_numbers

SAMPLES = 4000  # spread by area, beside the corners of the triangles
CORNERS = 20_000  # of more, evenly chosen ones
CORNER = np.array([[0.98, 0.01, 0.01], [0.01, 0.98, 0.01], [0.01, 0.01, 0.98]])


def deviation(surface: Surface, vertices: Array, faces: Array, tolerance: float) -> float:
    """Returns the larger of the two one-sided distances between a surface and the faces (k, 3) of a mesh, at samples,
    mm. Parts of a self-overlapping surface that lie inside it do not count."""
    made = Surface(vertices, faces, "mesh")
    points, normals = _samples(surface)
    there = distances(made.corners, points)
    far = np.flatnonzero(there > tolerance)
    if len(far):
        step = 1e-5 * surface.diagonal * normals[far]
        sides = [winding_numbers(surface, points[far] + sign * step) > 0.5 for sign in (1, -1)]
        there[far[sides[0] == sides[1]]] = 0
    back = distances(surface.corners, _samples(made)[0])
    return float(max(there.max(), back.max()))


def _samples(surface: Surface) -> tuple[Array, Array]:
    """Points of a surface, and its unit normals there."""
    random = np.random.default_rng(0)
    normals = surface.normals
    areas = np.linalg.norm(normals, axis=1)
    units = normals / np.maximum(areas, 1e-300)[:, None]
    chosen = random.choice(len(areas), SAMPLES, p=areas / areas.sum())
    weights = random.dirichlet([1, 1, 1], SAMPLES)
    inner = np.einsum("ij,ijk->ik", weights, surface.corners[chosen])
    corners = np.einsum("ci,tik->tck", CORNER, surface.corners).reshape(-1, 3)
    some = np.linspace(0, len(corners) - 1, min(len(corners), CORNERS)).astype(int)
    return np.concatenate([inner, corners[some]]), np.concatenate([units[chosen], units[some // 3]])
