"""Meshes of meshio and PyVista, out and in. Both are imported only here, when asked for."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arrays import Array
from .errors import InvalidInput
from .volume_mesh import VolumeMesh, compacted, positive

TETRAHEDRON, TRIANGLE = 10, 5  # cell types of VTK


def to_meshio(mesh: VolumeMesh) -> Any:
    """A meshio.Mesh: a block of triangles (those of face regions) and one of tetrahedra, regions as cell_sets, and as
    gmsh:physical and field_data, of which an element that is in several regions keeps the first. Throws ImportError."""
    meshio = _import("meshio")
    faces, members = _unique_faces(mesh)
    cells, sets, numbers = [], {}, []
    names = [*mesh.face_regions, *mesh.volume_regions]
    field_data = {
        name: np.array([number, 2 if name in mesh.face_regions else 3]) for number, name in enumerate(names, 1)
    }
    for kind, block, regions in (("triangle", faces, members), ("tetra", mesh.tetrahedra, mesh.volume_regions)):
        if len(block):
            cells.append((kind, block))
            numbers.append(_first_numbers(len(block), regions, field_data))
    for name in names:
        empty = np.empty(0, dtype=np.int64)
        own = members[name] if name in members else mesh.volume_regions[name]
        sets[name] = [own if (kind == "triangle") == (name in members) else empty for kind, _ in cells]
    return meshio.Mesh(
        mesh.vertices,
        cells,
        cell_sets=sets,
        cell_data={"gmsh:physical": numbers, "gmsh:geometrical": numbers},
        field_data=field_data,
    )


def from_meshio(mesh: Any) -> VolumeMesh:
    """Tetrahedra and triangles of a meshio.Mesh of order 1; regions from cell_sets, or from gmsh:physical. Lengths as
    they are, taken for mm. Throws InvalidInput."""
    kinds = [block.type for block in mesh.cells]
    _check_kinds(set(kinds), {"tetra", "triangle", "line", "vertex"})
    tetrahedra = [block.data for block in mesh.cells if block.type == "tetra"]
    if not tetrahedra:
        raise InvalidInput(f"the mesh has no tetrahedra, but {', '.join(kinds) or 'no cells'}")
    volumes: dict[str, list[Array]] = {}
    faces: dict[str, list[Array]] = {}
    for name, blocks in _meshio_sets(mesh).items():
        start = 0
        for block, chosen in zip(mesh.cells, blocks):
            chosen = np.asarray([] if chosen is None else chosen, dtype=np.int64)
            if block.type == "tetra" and len(chosen):
                volumes.setdefault(name, []).append(chosen + start)
            elif block.type == "triangle" and len(chosen):
                faces.setdefault(name, []).append(block.data[chosen])
            start += len(block.data) if block.type == "tetra" else 0
    return _made(mesh.points, np.concatenate(tetrahedra), _joined(volumes), _joined(faces))


def _meshio_sets(mesh: Any) -> dict[str, list[Any]]:
    sets = {name: blocks for name, blocks in (mesh.cell_sets or {}).items() if not name.startswith("gmsh:")}
    numbers = mesh.cell_data.get("gmsh:physical")
    if sets or numbers is None:
        return sets
    dimensions = {"vertex": 0, "line": 1, "triangle": 2, "tetra": 3}
    for name, (number, dimension) in {
        name: tuple(int(v) for v in value[:2]) for name, value in mesh.field_data.items()
    }.items():
        sets[name] = [
            np.flatnonzero(n == number) if dimensions[b.type] == dimension else [] for b, n in zip(mesh.cells, numbers)
        ]
    return sets


def to_pyvista(mesh: VolumeMesh) -> Any:
    """A pyvista.UnstructuredGrid of the tetrahedra and, once for every face region, its triangles. Cell array `region`:
    the number of the region, -1: none (of several regions of an element the first); field data `region_NAME`: the
    number of region NAME. As .vtu softkin reads that by name. Throws ImportError."""
    pyvista = _import("pyvista")
    numbers = {name: number for number, name in enumerate([*mesh.volume_regions, *mesh.face_regions])}
    of_cells = np.full(len(mesh.tetrahedra), -1)
    for name in reversed(list(mesh.volume_regions)):
        of_cells[mesh.volume_regions[name]] = numbers[name]
    cells = {TETRAHEDRON: mesh.tetrahedra}
    if mesh.face_regions:
        cells[TRIANGLE] = np.concatenate(list(mesh.face_regions.values()))
        of_faces = np.concatenate([np.full(len(faces), numbers[name]) for name, faces in mesh.face_regions.items()])
        of_cells = np.concatenate([of_cells, of_faces])
    grid = pyvista.UnstructuredGrid(cells, mesh.vertices)
    grid.cell_data["region"] = of_cells.astype(np.int32)
    for name, number in numbers.items():
        grid.field_data[f"region_{name}"] = np.array([number], dtype=np.int32)
    return grid


def from_pyvista(grid: Any) -> VolumeMesh:
    """Tetrahedra and triangles of a pyvista.UnstructuredGrid of order 1; regions from the cell array `region`, named by
    the field data `region_NAME`, else region_NUMBER. Lengths as they are, taken for mm. Throws InvalidInput."""
    if not hasattr(grid, "cells_dict") or not hasattr(grid, "celltypes"):
        raise InvalidInput(f"{type(grid).__name__} is no pyvista.UnstructuredGrid; for a surface take from_surfaces")
    _check_kinds(set(np.unique(grid.celltypes).tolist()), {TETRAHEDRON, TRIANGLE, 3, 1})
    cells = grid.cells_dict
    if TETRAHEDRON not in cells:
        raise InvalidInput("the grid has no tetrahedra")
    if "region" not in grid.cell_data:
        return _made(grid.points, cells[TETRAHEDRON], {}, {})
    names = {
        int(np.ravel(grid.field_data[key])[0]): key[len("region_") :]
        for key in grid.field_data.keys()
        if key.startswith("region_")
    }
    regions: list[dict[str, Array]] = []
    for kind in (TETRAHEDRON, TRIANGLE):
        numbers = np.asarray(grid.cell_data["region"])[grid.celltypes == kind]
        present = [int(number) for number in np.unique(numbers) if number >= 0]
        regions.append({names.get(number, f"region_{number}"): np.flatnonzero(numbers == number) for number in present})
    faces = {name: cells[TRIANGLE][chosen] for name, chosen in regions[1].items()}
    return _made(grid.points, cells[TETRAHEDRON], regions[0], faces)


def _made(points: Any, tetrahedra: Array, volumes: dict[str, Array], faces: dict[str, Array]) -> VolumeMesh:
    points = np.asarray(points, dtype=np.float64)
    tetrahedra = np.asarray(tetrahedra, dtype=np.int64)
    used = np.unique(tetrahedra)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    renumbered = {name: number[np.asarray(triangles, dtype=np.int64)] for name, triangles in faces.items()}
    for name, triangles in renumbered.items():
        if (triangles < 0).any():
            raise InvalidInput(f"region '{name}' has faces with vertices of no tetrahedron")
    vertices, cells = compacted(points, tetrahedra)
    shared = set(volumes) & set(renumbered)
    return VolumeMesh(
        vertices,
        positive(vertices, cells),
        volumes,
        {f"{n}_2d" if n in shared else n: t for n, t in renumbered.items()},
    )


def _unique_faces(mesh: VolumeMesh) -> tuple[Array, dict[str, Array]]:
    if not mesh.face_regions:
        return np.empty((0, 3), dtype=np.int64), {}
    every = np.concatenate(list(mesh.face_regions.values()))
    _, first, which = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_inverse=True)
    ends = np.cumsum([len(faces) for faces in mesh.face_regions.values()])[:-1]
    return every[first], dict(zip(mesh.face_regions, (np.unique(part) for part in np.split(which.reshape(-1), ends))))


def _first_numbers(count: int, regions: Any, field_data: dict[str, Array]) -> Array:
    numbers = np.zeros(count, dtype=np.int64)
    for name in reversed(list(regions)):
        numbers[regions[name]] = field_data[name][0]
    return numbers


def _joined(regions: dict[str, list[Array]]) -> dict[str, Array]:
    return {name: np.concatenate(blocks) for name, blocks in regions.items()}


def _check_kinds(present: set[Any], known: set[Any]) -> None:
    if present - known:
        raise InvalidInput(
            f"cells of kind {', '.join(map(str, sorted(present - known)))}: only tetrahedra and triangles of order 1"
            " are taken"
        )


def _import(name: str) -> Any:
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"this needs {name}: pip install {name} ({error})") from None
