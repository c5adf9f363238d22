"""Finer meshes of the examples' robots."""

from __future__ import annotations

import math
import sys
from typing import Any

from rows import ROOT

sys.path.insert(0, str(ROOT / "bench"))
import weights_study  # noqa: E402

Mesh: Any = weights_study.Mesh  # a study without types


def read(text: str) -> Any:
    """Of a .msh in ASCII."""
    return Mesh(text)


def refined(text: str, share: float) -> str:
    """The mesh with no edge longer than that share of its median edge."""
    mesh = Mesh(text)
    lengths = sorted(math.dist(mesh.vertices[a], mesh.vertices[b])
                     for kind, _, nodes in mesh.elements if kind == 4 for a in nodes for b in nodes if a < b)
    longest = share * lengths[len(lengths) // 2]
    mesh.refine(lambda _: longest)
    return str(mesh.text())
