"""Meshes to and from meshio and PyVista, where they are installed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .robot import Robot
    from .shape import Shape

TETRAHEDRON, WEDGE, TETRAHEDRON_2 = 10, 13, 24  # of VTK


def cells_of(robot: Robot) -> list[tuple[str, NDArray[np.int32]]]:
    """Blocks of elements, named as meshio does: tetrahedra first."""
    blocks = []
    if len(robot.edge_nodes):
        blocks.append(("tetra10", np.hstack([robot.tetrahedra, robot.edge_nodes])))
    elif len(robot.tetrahedra):
        blocks.append(("tetra", robot.tetrahedra))
    if len(robot.prisms):
        blocks.append(("wedge", robot.prisms))
    return blocks


def fields_of(shape: Shape) -> tuple[dict[str, NDArray[Any]], dict[str, NDArray[Any]]]:
    """Of the vertices and of the elements, with the names of the .vtu that `save` writes."""
    deformation, robot = shape.deformation, shape.robot
    points = {"displacement_mm": shape.displacements}
    elements: dict[str, NDArray[Any]] = {
        "volume_ratio": deformation.volume_ratio,
        "principal_strain_max": deformation.strain[:, 0],
        "principal_strain_min": deformation.strain[:, 2],
        "region": robot.element_regions,
    }
    if len(deformation.von_mises_MPa):
        elements["von_mises_MPa"] = deformation.von_mises_MPa
        points["reaction_N"] = shape.vertex_reactions
    return points, elements


def to_meshio(shape: Shape) -> Any:
    import meshio

    points, elements = fields_of(shape)
    blocks = cells_of(shape.robot)
    ends = np.cumsum([len(cells) for _, cells in blocks])[:-1]
    data = {name: np.split(values, ends) for name, values in elements.items()}
    return meshio.Mesh(np.array(shape.positions), blocks, point_data=points, cell_data=data)


def to_pyvista(shape: Shape) -> Any:
    import pyvista

    kinds = {"tetra": TETRAHEDRON, "tetra10": TETRAHEDRON_2, "wedge": WEDGE}
    blocks = {kinds[name]: cells for name, cells in cells_of(shape.robot)}
    grid = pyvista.UnstructuredGrid(blocks, np.array(shape.positions))
    points, elements = fields_of(shape)
    for name, values in points.items():
        grid.point_data[name] = values
    for name, values in elements.items():
        grid.cell_data[name] = values
    return grid


def from_meshio(mesh: Any) -> dict[str, Any]:
    """Vertices, elements and regions, as arguments of a Robot."""
    found = _Collected(np.asarray(mesh.points)[:, :3])
    names = {(int(tag), int(dimension)): name for name, (tag, dimension) in (mesh.field_data or {}).items()}
    tags = (mesh.cell_data or {}).get("gmsh:physical")
    for block, cells in enumerate(mesh.cells):
        first = found.add(cells.type, np.asarray(cells.data))
        if first is None:
            continue
        dimension = 2 if cells.type.startswith("triangle") else 3
        if tags is not None:
            for tag in np.unique(tags[block]):
                name = names.get((int(tag), dimension), f"physical_{dimension}_{int(tag)}")
                found.region(name, cells.type, first + np.flatnonzero(tags[block] == tag))
        for name, sets in (mesh.cell_sets or {}).items():
            if not name.startswith("gmsh:") and sets[block] is not None and len(sets[block]):
                found.region(name, cells.type, first + np.asarray(sets[block], dtype=np.int64))
    for name, vertices in (getattr(mesh, "point_sets", None) or {}).items():
        found.regions.setdefault(name, {"vertices": np.asarray(vertices)})
    return found.arguments()


def from_pyvista(grid: Any) -> dict[str, Any]:
    """The same; values of the cell array "region" are regions "region_0", ..."""
    found = _Collected(np.asarray(grid.points, dtype=np.float64))
    names = {TETRAHEDRON: "tetra", TETRAHEDRON_2: "tetra10", WEDGE: "wedge"}
    values = np.asarray(grid.cell_data["region"]) if "region" in grid.cell_data else None
    for kind, cells in grid.cells_dict.items():
        name = names.get(int(kind), f"VTK cell {kind}")
        first = found.add(name, np.asarray(cells))
        if values is None or first is None:
            continue
        of = values[np.asarray(grid.celltypes) == kind]
        for value in np.unique(of[of >= 0]):
            found.region(f"region_{int(value)}", name, first + np.flatnonzero(of == value))
    return found.arguments()


class _Collected:
    """Elements of several blocks."""

    def __init__(self, points: NDArray[Any]) -> None:
        self.points = points
        self.regions: dict[str, Any] = {}
        self._cells: dict[str, list[NDArray[Any]]] = {"tetrahedra": [], "prisms": [], "triangles": []}

    def add(self, kind: str, cells: NDArray[Any]) -> int | None:
        """Number of the first of them; None: elements that are not looked at."""
        keys = {"tetra": "tetrahedra", "tetra10": "tetrahedra", "wedge": "prisms", "triangle": "triangles"}
        key = keys.get(kind, "triangles" if kind == "triangle6" else None)
        if key is None:
            if kind.startswith(("vertex", "line", "quad")):
                return None
            raise ValueError(f"mesh has elements {kind}; a robot is of tetrahedra of order 1 or 2 and wedges")
        first = sum(len(block) for block in self._cells[key])
        self._cells[key].append(cells[:, :3] if key == "triangles" else cells)
        return first

    def region(self, name: str, kind: str, numbers: NDArray[Any]) -> None:
        if kind.startswith("triangle"):
            entry = {"triangles": np.concatenate(self._cells["triangles"])[numbers]}
            name = name if name not in self.regions else f"{name}_2d"
            self.regions[name] = entry
            return
        key = "prisms" if kind == "wedge" else "tetrahedra"
        entry = self.regions.setdefault(name, {})
        entry[key] = np.concatenate([entry[key], numbers]) if key in entry else numbers

    def arguments(self) -> dict[str, Any]:
        arguments: dict[str, Any] = {"vertices": self.points, "regions": self.regions}
        for key in ("tetrahedra", "prisms"):
            blocks = self._cells[key]
            if len({block.shape[1] for block in blocks}) > 1:
                raise ValueError("mesh has tetrahedra of order 1 and of order 2")
            if blocks:
                arguments[key] = np.concatenate(blocks)
        return arguments
