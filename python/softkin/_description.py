"""A robot's description, as Python gives it: arrays, dicts, lists, words and numbers."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import floats, indices, vector

Forces = Mapping[str, Sequence[float]]
Entries = Sequence[Mapping[str, Any]]


def plain(value: Any, path: str) -> Any:
    """Dicts, lists, words and numbers, as a scene has them; entries that are None are left out."""
    if isinstance(value, Mapping):
        return {str(key): plain(item, f"{path}.{key}") for key, item in value.items() if item is not None}
    if isinstance(value, np.ndarray):
        return plain(value.tolist(), path)
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Sequence):
        return [plain(item, f"{path}[{i}]") for i, item in enumerate(value)]
    raise TypeError(f"{path} must be of dicts, lists, words and numbers, not {type(value).__name__}")


def force_texts(forces: Forces | None) -> list[str]:
    if not forces:
        return []
    return [f"{name}=" + ",".join(repr(x) for x in vector(f"forces: {name}", force)) for name, force in forces.items()]


def yaml_text(value: object) -> str:
    """A number, a word or a list of them as a scene has it."""
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(yaml_text(each) for each in value) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else repr(float(value))  # type: ignore[arg-type]


def formulation_of(name: str | None) -> str:
    if name not in (None, "physical", "target-shape"):
        raise ValueError(f"formulation must be 'physical' or 'target-shape', not {name!r}")
    return name or ""


def mesh_of(
    vertices: ArrayLike, tetrahedra: ArrayLike | None, prisms: ArrayLike | None
) -> tuple[_core.Mesh, list[int]]:
    """And how many vertices, tetrahedra and prisms it has."""
    points = floats("vertices", vertices, (None, 3))
    many = len(points)
    nodes = 10 if tetrahedra is not None and np.ndim(tetrahedra) == 2 and np.shape(tetrahedra)[1] == 10 else 4
    tets = indices("tetrahedra", () if tetrahedra is None else tetrahedra, (None, nodes), many, "vertices")
    wedges = indices("prisms", () if prisms is None else prisms, (None, 6), many, "vertices")
    return _core.Mesh(points, tets, wedges), [many, len(tets), len(wedges)]


def add_region(mesh: _core.Mesh, sizes: list[int], name: str, value: Any) -> dict[str, Any] | None:
    """Puts a region into the mesh; or returns its entry of the description, where it is a shape."""
    vertices, tets, prisms = sizes
    none = np.zeros(0, np.int32)
    what = f"regions: {name}"
    if isinstance(value, Mapping):
        keys = set(value)
        if keys and keys <= {"tetrahedra", "prisms"}:
            of_tets = indices(what, value.get("tetrahedra", ()), (None,), tets, "tetrahedra")
            of_prisms = indices(what, value.get("prisms", ()), (None,), prisms, "prisms")
            mesh.add_volume(name, of_tets, of_prisms)
        elif keys == {"triangles"}:
            mesh.add_faces(name, indices(what, value["triangles"], (None, 3), vertices, "vertices"))
        elif keys == {"vertices"}:
            mesh.add_vertices(name, indices(what, value["vertices"], (None,), vertices, "vertices"))
        else:
            return {"name": name, **value}
    elif np.ndim(value) == 2:
        mesh.add_faces(name, indices(what, value, (None, 3), vertices, "vertices"))
    else:
        array = np.asarray(value)
        if array.dtype == bool:
            if array.shape != (tets,):
                raise ValueError(f"{what} must have shape ({tets},), a truth per tetrahedron, not {array.shape}")
            array = np.flatnonzero(array)
        mesh.add_volume(name, indices(what, array, (None,), tets, "tetrahedra"), none)
    return None
