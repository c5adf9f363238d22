"""Vertices of a mesh onto the surfaces that it follows."""

from __future__ import annotations

import numpy as np

from .arrays import Array
from .distance import feet, nearest
from .elements import boundary_faces, signed_volumes
from .labels import Labels
from .surface import Surface

WORSE = 0.5  # of the quality before: vertices that would make a tetrahedron worse than that stay where they are


def snapped(points: Array, tetrahedra: Array, labels: Labels, surfaces: dict[str, Surface], tolerance: float) -> Array:
    """The points, (n, 3), with those at the boundary of what is inside a surface moved to its nearest place, so that
    flat faces become exactly flat. Those on several surfaces follow the first."""
    target = points.copy()
    free = np.ones(len(points), dtype=bool)
    for name, surface in surfaces.items():
        rim = np.unique(boundary_faces(tetrahedra[labels.inside[name]]))
        rim = rim[free[rim]]
        gaps, triangle = nearest(surface.corners, points[rim])
        near = gaps <= 2 * tolerance
        target[rim[near]] = feet(points[rim[near]], surface.corners[triangle[near]])
        free[rim] = False
    cells = tetrahedra[labels.kept]
    before = _qualities(points, cells)
    while True:
        bad = _qualities(target, cells) < WORSE * before
        moved = np.unique(cells[bad])
        moved = moved[(target[moved] != points[moved]).any(axis=1)]
        if len(moved) == 0:
            return target
        target[moved] = points[moved]


def _qualities(points: Array, cells: Array) -> Array:
    """Volumes over the mean squares of edges to the power of 3/2."""
    corners = points[cells]
    middles = corners.mean(axis=1, keepdims=True)
    spread: Array = ((corners - middles) ** 2).sum(axis=(1, 2))
    return np.asarray(signed_volumes(points, cells) / np.maximum(spread, 1e-300) ** 1.5)
