"""Mesh files of any form that softkin reads: looked at, checked, converted."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from .. import _core
from .._core import InvalidInput

__all__ = ["check", "convert", "info"]

PathLike = str | os.PathLike[str]
UNITS = ("mm", "cm", "m", "um", "in")


def _unit(file: PathLike, unit: str | None) -> str:
    if unit is None:
        return "mm"
    if Path(file).suffix in (".yaml", ".yml"):
        raise InvalidInput("unit: a scene names its own unit")
    if unit not in UNITS:
        raise InvalidInput(f"unit must be one of {', '.join(UNITS)}, not {unit!r}")
    return unit


def info(file: PathLike, unit: str | None = None) -> dict[str, Any]:
    """Counts, regions, size, volume, quality and edge lengths: what `softkin mesh info --json` prints.

    file  .msh, .vtk, .vtu, .mesh, .node, .ele, .inp or .tet; or a scene, .yaml
    unit  of the file's lengths: 'mm', 'cm', 'm', 'um' or 'in'; None: mm, or the scene's
    """
    report: dict[str, Any] = json.loads(_core.mesh_info(os.fspath(file), _unit(file, unit)))
    return report


def check(file: PathLike, unit: str | None = None) -> tuple[bool, dict[str, Any]]:
    """What is wrong with a mesh: is it usable, and what `softkin mesh check --json` prints.

    file, unit  as info's; of a scene also whether it holds every part of its mesh
    """
    text, usable = _core.mesh_check(os.fspath(file), _unit(file, unit))
    return usable, json.loads(text)


def convert(file: PathLike, output: PathLike, *, ascii: bool = False) -> dict[str, Any]:
    """Writes a mesh in another form; lengths stay as they are. Returns what `softkin mesh convert --json` prints.

    output  .msh (all regions), .vtu (volume regions) or .stl (boundary); replaced where it exists
    ascii   a .msh as text
    """
    if ascii and Path(output).suffix != ".msh":
        raise InvalidInput(f"ascii: only a .msh can be written as text, not {os.fspath(output)!r}")
    report: dict[str, Any] = json.loads(_core.mesh_convert(os.fspath(file), os.fspath(output), ascii))
    return report
