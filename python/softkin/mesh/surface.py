"""Surfaces as they are given."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .._kinds import shown
from .errors import InvalidInput
from .surface_files import read_surface
from .triangles import Surface

__all__ = ["MM_PER_UNIT", "Surface", "SurfaceLike", "as_surface"]

MM_PER_UNIT = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 1e-3, "in": 25.4}
SurfaceLike = Any  # a file, a Surface, a pair of arrays, a PyVista PolyData, a meshio Mesh


def as_surface(given: SurfaceLike, name: str) -> Surface:
    """A surface from a file name, a `Surface`, a pair (vertices, triangles), or what has points and triangles
    (a PyVista PolyData, a meshio Mesh). Lengths as they are. Throws InvalidInput."""
    if isinstance(given, (str, Path)):
        return read_surface(given)
    if isinstance(given, Surface):
        return Surface(
            given.vertices, given.triangles, given.name if given.name != "surface" else name, given.notes
        ).merged()
    if isinstance(given, (tuple, list)) and len(given) == 2:
        return Surface(np.asarray(given[0]), np.asarray(given[1]), name).merged()
    if hasattr(given, "regular_faces") or hasattr(given, "is_all_triangles"):  # pyvista.PolyData
        flat = given if given.is_all_triangles else given.triangulate()
        return Surface(
            np.asarray(flat.points, dtype=float), np.asarray(flat.faces).reshape(-1, 4)[:, 1:], name
        ).merged()
    if hasattr(given, "cells_dict") and hasattr(given, "points"):  # meshio.Mesh
        return Surface(given.points, given.cells_dict.get("triangle", np.empty((0, 3), dtype=int)), name).merged()
    raise InvalidInput(
        f"{name}: a surface is a file, a softkin.mesh.Surface, or a pair (vertices, triangles); not"
        f" {shown(given)}"
    )
