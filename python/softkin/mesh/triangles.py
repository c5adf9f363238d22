"""Triangulated surfaces."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .arrays import Array, Floats, Indices
from .errors import InvalidInput


@dataclass(frozen=True)
class Surface:
    """A triangulated surface.

    vertices: (n, 3) float64, mm. triangles: (k, 3) int64, counterclockwise seen from outside. name: for messages.
    Points at the same place are one vertex after `merged`; readers of files return such surfaces.
    """

    vertices: Floats
    triangles: Indices
    name: str = "surface"
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        vertices = np.ascontiguousarray(self.vertices, dtype=np.float64)
        triangles = np.asarray(self.triangles)
        if vertices.ndim != 2 or vertices.shape[1] != 3:
            raise InvalidInput(f"{self.name}: vertices have shape {vertices.shape}; give (n, 3)")
        if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
            raise InvalidInput(
                f"{self.name}: triangles have shape {triangles.shape} of {triangles.dtype}; give (k, 3) of integers"
            )
        if len(triangles) == 0:
            raise InvalidInput(f"{self.name}: no triangles")
        if not np.isfinite(vertices).all():
            bad = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
            raise InvalidInput(f"{self.name}: vertex {bad} is not finite: {vertices[bad].tolist()}")
        if triangles.min() < 0 or triangles.max() >= len(vertices):
            bad = int(np.flatnonzero(((triangles < 0) | (triangles >= len(vertices))).any(axis=1))[0])
            raise InvalidInput(
                f"{self.name}: triangle {bad} is {triangles[bad].tolist()}, but vertices go from 0 to"
                f" {len(vertices) - 1}"
            )
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "triangles", np.ascontiguousarray(triangles, dtype=np.int64))

    def __repr__(self) -> str:
        size = " x ".join(f"{length:g}" for length in np.round(self.size, 3))
        return f"Surface({self.name!r}, {len(self.triangles)} triangles, {len(self.vertices)} vertices, {size} mm)"

    @property
    def corners(self) -> Floats:
        """Corners of the triangles, (k, 3, 3), mm."""
        return self.vertices[self.triangles]

    @property
    def size(self) -> Floats:
        """Edge lengths of the bounding box, (3,), mm."""
        used = self.vertices[np.unique(self.triangles)]
        size: Floats = used.max(axis=0) - used.min(axis=0)
        return size

    @property
    def diagonal(self) -> float:
        """Diagonal of the bounding box, mm."""
        return float(np.linalg.norm(self.size))

    @property
    def normals(self) -> Floats:
        """Normals of the triangles, as long as their areas, (k, 3), mm^2."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        normals: Floats = np.cross(b - a, c - a) / 2
        return normals

    @property
    def area(self) -> float:
        """mm^2."""
        return float(np.linalg.norm(self.normals, axis=1).sum())

    @property
    def volume(self) -> float:
        """Volume inside, mm^3; of a surface that is not closed, that with cones from its middle over its holes."""
        corners = self.corners - self.vertices[np.unique(self.triangles)].mean(axis=0)
        return float(np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6)

    def scaled(self, factor: float) -> Surface:
        return Surface(self.vertices * factor, self.triangles, self.name, self.notes)

    def with_triangles(self, triangles: Array, *notes: str, vertices: Array | None = None) -> Surface:
        points = self.vertices if vertices is None else vertices
        return Surface(points, triangles, self.name, self.notes + notes)

    def merged(self) -> Surface:
        """Points at the same place made one; triangles without area, doubled ones and unused vertices left out."""
        points, index = np.unique(self.vertices + 0.0, axis=0, return_inverse=True)  # + 0.0: -0 and 0 are one place
        triangles = index.reshape(-1)[self.triangles]
        corners = np.sort(triangles, axis=1)
        proper = (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2])
        a, b, c = np.moveaxis(points[triangles], 1, 0)
        proper &= np.any(np.cross(b - a, c - a) != 0, axis=1)
        _, first = np.unique(corners, axis=0, return_index=True)
        chosen = np.zeros(len(triangles), dtype=bool)
        chosen[first] = True
        triangles = triangles[proper & chosen]
        if len(triangles) == 0:
            raise InvalidInput(f"{self.name}: no triangle has an area")
        used, renumbered = np.unique(triangles, return_inverse=True)
        return Surface(points[used], renumbered.reshape(-1, 3), self.name, self.notes)
