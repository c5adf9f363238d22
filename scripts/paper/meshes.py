"""Makes finer meshes of the examples' robots."""

from __future__ import annotations

import math
import sys
from typing import Any

from rows import ROOT

sys.path.insert(0, str(ROOT / "bench"))
import weights_study  # noqa: E402

Mesh: Any = weights_study.Mesh  # weights_study.py has no type annotations


def read(text: str) -> Any:
    """Reads the text of a .msh in ASCII."""
    return Mesh(text)


def refined(text: str, edge_ratio: float) -> str:
    """Refines a mesh until no edge is longer than edge_ratio times its median edge."""
    mesh = Mesh(text)
    lengths = sorted(math.dist(mesh.vertices[a], mesh.vertices[b])
                     for kind, _, nodes in mesh.elements if kind == 4 for a in nodes for b in nodes if a < b)
    max_length = edge_ratio * lengths[len(lengths) // 2]
    mesh.refine(lambda _: max_length)
    return str(mesh.text())
