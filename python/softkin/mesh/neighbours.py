"""Meshes of tetrahedra and prisms as meshes of meshio and PyVista, and back."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import neighbours
from .arrays import Array
from .elements import MeshData, positive, renumbering
from .errors import InvalidInput

if TYPE_CHECKING:
    import meshio
    import pyvista

TETRAHEDRON, PRISM, TRIANGLE = 10, 13, 5  # cell types of VTK


def to_meshio(mesh: MeshData) -> meshio.Mesh:
    """A meshio.Mesh: a block of triangles (those of face regions), of tetrahedra and of wedges, regions as cell_sets, and as
    gmsh:physical and field_data, of which an element that is in several regions keeps the first. Throws ImportError."""
    faces, members = _unique_faces(mesh)
    cells, sets, numbers = [], {}, []
    names = [*mesh.face_regions, *mesh.volume_regions]
    field_data = {
        name: np.array([number, 2 if name in mesh.face_regions else 3]) for number, name in enumerate(names, 1)
    }
    first, empty = len(mesh.tetrahedra), np.empty(0, dtype=np.int64)
    of_kind = {
        "triangle": members,
        "tetra": {name: region[region < first] for name, region in mesh.volume_regions.items()},
        "wedge": {name: region[region >= first] - first for name, region in mesh.volume_regions.items()},
    }
    for kind, block in (("triangle", faces), ("tetra", mesh.tetrahedra), ("wedge", mesh.prisms)):
        if len(block):
            cells.append((kind, block))
            numbers.append(_first_numbers(len(block), of_kind[kind], field_data))
    for name in names:
        sets[name] = [of_kind[kind].get(name, empty) for kind, _ in cells]
    return neighbours.package("meshio").Mesh(
        mesh.vertices,
        cells,
        cell_sets=sets,
        cell_data={"gmsh:physical": numbers, "gmsh:geometrical": numbers},
        field_data=field_data,
    )


def from_meshio(mesh: meshio.Mesh) -> dict[str, Any]:
    """Tetrahedra of order 1 and wedges of a meshio.Mesh; regions of elements and faces from cell_sets and gmsh:physical. Lengths as
    they are, taken for mm. Throws InvalidInput."""
    return _arguments(neighbours.from_meshio(mesh))


def to_pyvista(mesh: MeshData) -> pyvista.UnstructuredGrid:
    """A pyvista.UnstructuredGrid of the tetrahedra, the wedges and, once for every face region, its triangles. Cell array `region`:
    the number of the region, -1: none (of several regions of an element the first); field data `region_NAME`: the
    number of region NAME. As .vtu softkin reads that by name. Throws ImportError."""
    numbers = {name: number for number, name in enumerate([*mesh.volume_regions, *mesh.face_regions])}
    of_cells = np.full(len(mesh.tetrahedra) + len(mesh.prisms), -1)
    for name in reversed(list(mesh.volume_regions)):
        of_cells[mesh.volume_regions[name]] = numbers[name]
    kinds = ((TETRAHEDRON, mesh.tetrahedra), (PRISM, mesh.prisms))
    cells = {kind: block for kind, block in kinds if len(block)}
    if mesh.face_regions:
        cells[TRIANGLE] = np.concatenate(list(mesh.face_regions.values()))
        of_faces = np.concatenate([np.full(len(faces), numbers[name]) for name, faces in mesh.face_regions.items()])
        of_cells = np.concatenate([of_cells, of_faces])
    grid = neighbours.package("pyvista").UnstructuredGrid(cells, mesh.vertices)
    grid.cell_data["region"] = of_cells.astype(np.int32)
    for name, number in numbers.items():
        grid.field_data[f"region_{name}"] = np.array([number], dtype=np.int32)
    return grid


def from_pyvista(grid: pyvista.UnstructuredGrid) -> dict[str, Any]:
    """Tetrahedra of order 1 and wedges of a pyvista.UnstructuredGrid; regions of elements and faces from the cell array `region`,
    named by the field data `region_NAME`, else region_NUMBER. Lengths as they are, taken for mm. Throws InvalidInput."""
    return _arguments(neighbours.from_pyvista(grid))


def _arguments(read: neighbours.Elements) -> dict[str, Any]:
    """Of a VolumeMesh."""
    if read.tetrahedra.shape[1] != 4:
        raise InvalidInput(
            "the mesh has tetrahedra of order 2: a VolumeMesh has those of order 1; softkin.Robot takes others"
        )
    number = renumbering(len(read.points), read.tetrahedra, read.prisms)
    faces = {name: number[region["triangles"]] for name, region in read.regions.items() if "triangles" in region}
    for name, triangles in faces.items():
        if (triangles < 0).any():
            raise InvalidInput(f"region '{name}' has faces with vertices of no element")
    vertices, cells = read.points[number >= 0], number[read.tetrahedra]
    volumes = {}
    for name, region in read.regions.items():
        parts = [region[kind] + first for kind, first in (("tetrahedra", 0), ("prisms", len(cells))) if kind in region]
        if parts:
            volumes[name] = np.concatenate(parts)
    return {
        "vertices": vertices,
        "tetrahedra": positive(vertices, cells),
        "volume_regions": volumes,
        "face_regions": faces,
        "prisms": number[read.prisms],
    }


def _unique_faces(mesh: MeshData) -> tuple[Array, dict[str, Array]]:
    if not mesh.face_regions:
        return np.empty((0, 3), dtype=np.int64), {}
    every = np.concatenate(list(mesh.face_regions.values()))
    _, first, which = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_inverse=True)
    ends = np.cumsum([len(faces) for faces in mesh.face_regions.values()])[:-1]
    return every[first], dict(zip(mesh.face_regions, (np.unique(part) for part in np.split(which.reshape(-1), ends))))


def _first_numbers(count: int, regions: Mapping[str, Array], field_data: dict[str, Array]) -> Array:
    numbers = np.zeros(count, dtype=np.int64)
    for name in reversed(list(regions)):
        numbers[regions[name]] = field_data[name][0]
    return numbers
