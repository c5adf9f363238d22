"""Layers of prisms upon triangles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .arrays import Array, Floats
from .elements import MeshData, check_name, prism_volumes, renumbering
from .errors import InvalidInput
from .triangles import Surface


def upon(mesh: MeshData, region: str, layers: Mapping[str, float]) -> dict[str, Any]:
    """Arguments of the VolumeMesh that VolumeMesh.with_layer makes."""
    if region not in mesh.face_regions:
        raise InvalidInput(f"no region of faces '{region}'; there are: {', '.join(mesh.face_regions) or 'none'}")
    outer = {tuple(sorted(face)): face for face in mesh.boundary().triangles.tolist()}
    chosen = [outer.get(tuple(sorted(face))) for face in mesh.face_regions[region].tolist()]
    if None in chosen:
        raise InvalidInput(f"region '{region}' has faces that are not on the boundary of the mesh")
    below = Surface(mesh.vertices, np.array(chosen, dtype=np.int64), f"region '{region}'")
    check_layers(below, layers)
    taken = [name for name in (*layers, f"{list(layers)[-1]}_top") if name in mesh.regions]
    if taken:
        raise InvalidInput(f"'{taken[0]}' is a region already; give the layer another name")
    first = len(mesh.tetrahedra) + len(mesh.prisms)
    vertices, prisms, regions, top = prisms_upon(mesh.vertices, below.triangles, layers, first)
    faces = {**mesh.face_regions, f"{list(layers)[-1]}_top": top}
    return {
        "vertices": vertices,
        "tetrahedra": mesh.tetrahedra,
        "volume_regions": {**mesh.volume_regions, **regions},
        "face_regions": faces,
        "prisms": np.concatenate([mesh.prisms, prisms]),
    }


def check_layers(surface: Surface, layers: Mapping[str, float]) -> None:
    if not layers:
        raise InvalidInput("layers: give one at least, its name and its thickness in mm")
    for name, thickness in layers.items():
        check_name(name)
        if not (np.isfinite(thickness) and thickness > 0):
            raise InvalidInput(f"layers: '{name}': thickness {thickness!r}: give a length in mm, > 0")
    edges = surface.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    _, count = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    if (count > 2).any():
        raise InvalidInput(f"{surface.name}: an edge belongs to more than two triangles: a layer has no place there")
    if len(np.unique(edges, axis=0)) < len(edges):
        raise InvalidInput(f"{surface.name}: neighbouring triangles are turned against each other")


def prisms_upon(
    points: Array, triangles: Array, layers: Mapping[str, float], first: int
) -> tuple[Floats, Array, dict[str, Array], Array]:
    """Vertices, those of the layers last; prisms; regions, numbered from `first` on; the outermost faces."""
    place = renumbering(len(points), triangles)
    used = np.flatnonzero(place >= 0)
    directions = _directions(points, triangles, used, place)
    vertices, prisms, regions, below, height = [points], [], {}, triangles, 0.0
    for k, (name, thickness) in enumerate(layers.items()):
        height += thickness
        vertices.append(points[used] + height * directions)
        above = len(points) + k * len(used) + place[triangles]
        prisms.append(np.hstack([below, above]))
        regions[name] = first + k * len(triangles) + np.arange(len(triangles))
        below = above
    made, joined = np.concatenate(vertices), np.concatenate(prisms)
    _check_volumes(made, joined, list(layers), len(triangles))
    return made, joined, regions, below


def _directions(points: Array, triangles: Array, used: Array, place: Array) -> Floats:
    """Returns the offset of each vertex for a layer of thickness 1: its product with the normals of all adjacent faces
    is 1, in the least-squares sense weighted by the faces' angles at the vertex, and its length is minimal."""
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    if (lengths <= 0).any():
        raise InvalidInput(f"triangle {int(np.flatnonzero(lengths <= 0)[0])} has no area")
    normals /= lengths[:, None]
    matrices, sides = np.zeros((len(used), 3, 3)), np.zeros((len(used), 3))
    corners = (a, b, c)
    for k in range(3):
        one, other = corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]
        angles = np.arctan2(lengths, np.einsum("ij,ij->i", one, other))
        np.add.at(matrices, place[triangles[:, k]], angles[:, None, None] * normals[:, :, None] * normals[:, None, :])
        np.add.at(sides, place[triangles[:, k]], angles[:, None] * normals)
    directions: Floats = np.einsum("ijk,ik->ij", np.linalg.pinv(matrices, rcond=1e-3, hermitian=True), sides)
    return directions


def _check_volumes(vertices: Array, prisms: Array, names: list[str], count: int) -> None:
    """Throws where a layer folds: where a triangle above is turned against that below."""
    folded = prism_volumes(vertices, prisms) <= 0
    corners = vertices[prisms]
    bottom, top = (np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0]) for c in (corners[:, :3], corners[:, 3:]))
    folded |= np.einsum("ij,ij->i", bottom, top) <= 0
    if folded.any():
        number = int(np.flatnonzero(folded)[0])
        place = ", ".join(f"{x:.4g}" for x in corners[number].mean(axis=0))
        raise InvalidInput(
            f"layer '{names[number // count]}' folds at ({place}) mm: it is thicker than the surface's bend allows there"
        )
