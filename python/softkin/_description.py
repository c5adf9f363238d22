"""A robot's description, as Python gives it: arrays, dicts, lists, words and numbers."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import dimensions, floats, indices, vector
from ._core import InvalidInput
from ._kinds import FLOAT, INT, shown

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
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) > 2**63:
        raise InvalidInput(f"{path} is too large a number: {shown(value)}")
    if isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray)):
        return [plain(item, f"{path}[{i}]") for i, item in enumerate(value)]
    raise InvalidInput(f"{path} must be of dicts, lists, words and numbers, not {shown(value)}")


def force_texts(forces: Forces | None) -> list[str]:
    if not forces:
        return []
    return [f"{name}=" + ",".join(repr(x) for x in vector(f"forces: {name}", force)) for name, force in forces.items()]


def changes_of(changes: Mapping[str, object] | None) -> list[str]:
    """Changes of a scene, PATH=VALUE each."""
    return [f"{path}={yaml_text(value, f'changes: {path}')}" for path, value in (changes or {}).items()]


def yaml_text(value: object, name: str) -> str:
    """A number, a truth, a word, or lists and dicts of them, as a scene has it. A word stands as it is."""
    if isinstance(value, np.ndarray):
        return yaml_text(value.tolist(), name)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(yaml_text(each, f"{name}[{i}]") for i, each in enumerate(value)) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {yaml_text(each, f'{name}.{key}')}" for key, each in value.items()) + "}"
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value)).lower()
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    for kind in (INT, FLOAT):
        if kind.is_of(value):
            if fault := kind.fault(name, value):
                raise InvalidInput(fault)
            return repr(int(value) if kind is INT else float(value))  # type: ignore[call-overload,arg-type]
    raise InvalidInput(f"{name} must be a number, a text, or a list or dictionary of these, not {shown(value)}")


def formulation_of(name: str | None) -> str:
    if name not in (None, "physical", "target-shape"):
        raise InvalidInput(f"formulation must be 'physical' or 'target-shape', not {name!r}")
    return name or ""


def mesh_of(
    vertices: ArrayLike, tetrahedra: ArrayLike | None, prisms: ArrayLike | None
) -> tuple[_core.Mesh, list[int]]:
    """And how many vertices, tetrahedra and prisms it has."""
    points = floats("vertices", vertices, (None, 3))
    many = len(points)
    flat = tetrahedra is None or dimensions("tetrahedra", tetrahedra) != 2
    nodes = 10 if not flat and np.shape(np.asarray(tetrahedra))[-1] == 10 else 4
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
    elif dimensions(what, value) == 2:
        mesh.add_faces(name, indices(what, value, (None, 3), vertices, "vertices"))
    else:
        array = np.asarray(value)
        if array.dtype == bool:
            if array.shape != (tets,):
                raise InvalidInput(f"{what} must have shape ({tets},), a truth per tetrahedron, not {array.shape}")
            array = np.flatnonzero(array)
        mesh.add_volume(name, indices(what, array, (None,), tets, "tetrahedra"), none)
    return None
