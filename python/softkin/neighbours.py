"""Meshes to and from meshio and PyVista, where they are installed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._core import InvalidInput
from ._kinds import shown

if TYPE_CHECKING:
    import meshio
    import pyvista

VTK_KINDS = {1: "vertex", 3: "line", 5: "triangle", 9: "quad", 10: "tetra", 13: "wedge", 21: "line3", 22: "triangle6",
             23: "quad8", 24: "tetra10"}  # as meshio names them  # fmt: skip
VTK_NUMBERS = {kind: number for number, kind in VTK_KINDS.items()}
PLACES = {"tetra": "tetrahedra", "tetra10": "tetrahedra", "wedge": "prisms", "triangle": "triangles",
          "triangle6": "triangles"}  # fmt: skip
PASSED_OVER = ("vertex", "line", "quad")
Ints = NDArray[np.int64]
Points = NDArray[np.float64]
Blocks = Sequence[tuple[str, NDArray[np.int32]]]  # of elements, named as meshio does
Fields = Mapping[str, NDArray[Any]]  # by name


class Content(NamedTuple):
    """The arrays of a shape's .vtu, in addition to points and cells."""

    points: Fields
    """of the vertices"""
    cells: Fields
    """of the cells, in their order"""
    whole: Fields
    """of the whole"""


@dataclass(frozen=True)
class Elements:
    """The elements and regions of a mesh of meshio or PyVista."""

    points: NDArray[np.float64]
    """(n, 3)"""
    tetrahedra: Ints
    """(k, 4), or (k, 10) of order 2"""
    prisms: Ints
    """(k, 6)"""
    regions: dict[str, dict[str, Ints]]
    """by name: numbers of "tetrahedra" and "prisms"; or "triangles", (f, 3) vertices; or "vertices" """

    def arguments(self, regions: Mapping[str, Any] | None) -> dict[str, Any]:
        """Of a Robot; regions: others, which come first."""
        return {
            "vertices": self.points,
            "tetrahedra": self.tetrahedra,
            "prisms": self.prisms,
            "regions": {**self.regions, **(regions or {})},
        }


def package(name: str) -> Any:
    """meshio or pyvista. Throws ImportError that says how to get it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise ImportError(f"this needs {name}: pip install {name} ({error})") from None


def to_meshio(positions: Points, blocks: Blocks, content: Content) -> meshio.Mesh:
    """Without what is of the whole, for which meshio has no place."""
    ends = np.cumsum([len(cells) for _, cells in blocks])[:-1]
    data = {name: np.split(values, ends) for name, values in content.cells.items()}
    return package("meshio").Mesh(positions, blocks, point_data=dict(content.points), cell_data=data)


def to_pyvista(positions: Points, blocks: Blocks, content: Content) -> pyvista.UnstructuredGrid:
    """Field data region_NAME: the number of region NAME, as in the .vtu that `save` writes."""
    cells = {VTK_NUMBERS[name]: block for name, block in blocks}
    grid = package("pyvista").UnstructuredGrid(cells, positions)
    for data, fields in (
        (grid.point_data, content.points),
        (grid.cell_data, content.cells),
        (grid.field_data, content.whole),
    ):
        for name, values in fields.items():
            data[name] = values
    return grid


def from_meshio(mesh: meshio.Mesh) -> Elements:
    """Regions: cell sets, point sets, and physical groups (`gmsh:physical`) that no cell set has the name of; such
    without a name are physical_DIMENSION_NUMBER, as the command reads them. Throws InvalidInput."""
    if not hasattr(mesh, "cells") or not hasattr(mesh, "points"):
        raise InvalidInput(f"mesh must be a meshio.Mesh, not {shown(mesh)}")
    blocks = [(str(block.type), np.asarray(block.data, dtype=np.int64)) for block in mesh.cells]
    sets = {name: parts for name, parts in (mesh.cell_sets or {}).items() if not name.startswith("gmsh:")}
    names = {tuple(int(x) for x in value[:2]): name for name, value in (mesh.field_data or {}).items()}
    groups: dict[str, list[Any]] = {}
    for place, numbers in enumerate((mesh.cell_data or {}).get("gmsh:physical") or ()):
        dimension = 2 if blocks[place][0].startswith("triangle") else 3
        for number in np.unique(numbers).tolist():
            name = names.get((number, dimension), f"physical_{dimension}_{number}")
            if number != 0 and name not in sets:  # 0: in no group
                groups.setdefault(name, [None] * len(blocks))[place] = np.flatnonzero(np.asarray(numbers) == number)
    points = getattr(mesh, "point_sets", None) or {}
    return _elements(np.asarray(mesh.points, dtype=np.float64)[:, :3], blocks, {**sets, **groups}, points)


def from_pyvista(grid: pyvista.UnstructuredGrid) -> Elements:
    """Regions: values of the cell array `region`, named by the field data `region_NAME`, else region_NUMBER. Throws
    InvalidInput."""
    if not hasattr(grid, "cells_dict") or not hasattr(grid, "celltypes"):
        raise InvalidInput(
            f"grid must be a pyvista.UnstructuredGrid, not {shown(grid)}; for a surface take softkin.mesh.from_surfaces"
        )
    kinds = {int(kind): np.asarray(cells, dtype=np.int64) for kind, cells in grid.cells_dict.items()}
    blocks = [(VTK_KINDS.get(kind, f"VTK cell {kind}"), cells) for kind, cells in kinds.items()]
    sets: dict[str, list[Any]] = {}
    if "region" in grid.cell_data:
        values = np.asarray(grid.cell_data["region"])
        own = [key for key in grid.field_data.keys() if key.startswith("region_")]
        names = {int(np.ravel(grid.field_data[key])[0]): key[len("region_") :] for key in own}
        parts = [values[np.asarray(grid.celltypes) == kind] for kind in kinds]
        for number in np.unique(values[values >= 0]).tolist():
            sets[names.get(number, f"region_{number}")] = [np.flatnonzero(part == number) for part in parts]
    return _elements(np.asarray(grid.points, dtype=np.float64), blocks, sets, {})


def _elements(
    points: NDArray[np.float64],
    blocks: Sequence[tuple[str, Ints]],
    sets: Mapping[str, Sequence[Any]],
    point_sets: Mapping[str, Any],
) -> Elements:
    """sets: by name, members of each block or None. Of a set of elements and faces the faces are NAME_2d."""
    unknown = sorted({kind for kind, _ in blocks if kind not in PLACES and not kind.startswith(PASSED_OVER)})
    if unknown:
        kinds = ", ".join(unknown)
        raise InvalidInput(f"cells of kind {kinds}: only tetrahedra, wedges, and triangles as faces are taken")
    cells: dict[str, list[Ints]] = {"tetrahedra": [], "prisms": [], "triangles": []}
    firsts = []  # of each block among those of its place
    for kind, block in blocks:
        place = PLACES.get(kind, "")
        firsts.append(sum(len(other) for other in cells.get(place, ())))
        if place:
            cells[place].append(block[:, :3] if place == "triangles" else block)
    if len({block.shape[1] for block in cells["tetrahedra"]}) > 1:
        raise InvalidInput("the mesh has tetrahedra of order 1 and of order 2")
    if not cells["tetrahedra"] and not cells["prisms"]:
        has = ", ".join(sorted({kind for kind, _ in blocks})) or "no cells"
        raise InvalidInput(f"the mesh has no tetrahedra and no wedges, but {has}")
    width = {"tetrahedra": 4, "prisms": 6, "triangles": 3}
    joined = {
        place: np.concatenate(parts) if parts else np.zeros((0, width[place]), np.int64)
        for place, parts in cells.items()
    }
    regions: dict[str, dict[str, Ints]] = {}
    for name, parts in sets.items():
        found: dict[str, list[Ints]] = {}
        for (kind, _), first, part in zip(blocks, firsts, parts):
            if kind in PLACES and part is not None and len(part):
                found.setdefault(PLACES[kind], []).append(first + np.asarray(part, dtype=np.int64))
        members = {place: np.concatenate(numbers) for place, numbers in found.items()}
        faces = members.pop("triangles", None)
        if members:
            regions[name] = members
        if faces is not None:
            regions[f"{name}_2d" if members else name] = {"triangles": joined["triangles"][faces]}
    for name, vertices in point_sets.items():
        regions.setdefault(name, {"vertices": np.asarray(vertices, dtype=np.int64)})
    return Elements(points, joined["tetrahedra"], joined["prisms"], regions)
