"""Sheets of prisms by extrusion."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from .elements import renumbering
from .layers import check_layers, prisms_upon
from .surface import SurfaceLike, as_surface
from .volume_mesh import VolumeMesh


def stacked(surface: SurfaceLike, layers: Mapping[str, float], *, name: str = "surface") -> VolumeMesh:
    """A sheet of layers of prisms upon a triangulated surface, such as an elastomer between its frames.

    surface: what `from_surfaces` takes: a file, a Surface, (vertices, triangles); lengths in mm. It may be open, flat
    or curved; its triangles are the faces of prisms, so they stay as they are. layers: from the surface on, along its
    normals (counterclockwise seen from there), name to thickness in mm. Each layer is one prism thick and a region of
    elements; the faces of the first below are the region of faces 'bottom', those of the last above 'top'. Thickness is
    that square to each face where the surface is flat or bends along lines, and to the least squares at its corners.
    Throws InvalidInput: no thickness, names, edges of more than two triangles, triangles that are turned against their
    neighbours, layers thicker than the surface's bends allow.
    """
    given = as_surface(surface, name)
    check_layers(given, layers)
    vertices, prisms, regions, top = prisms_upon(given.vertices, given.triangles, layers, 0)
    number = renumbering(len(vertices), prisms)
    faces = {"bottom": number[given.triangles[:, [0, 2, 1]]], "top": number[top]}
    none = np.empty((0, 4), dtype=np.int64)
    return VolumeMesh(vertices[number >= 0], none, regions, faces, prisms=number[prisms])
