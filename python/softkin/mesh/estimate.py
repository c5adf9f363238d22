"""How large a mesh will be, before it is made."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence

import numpy as np

from .. import _core
from .errors import InvalidInput, MeshWarning
from .surface import Surface

REGULAR = 1 / (6 * math.sqrt(2))  # volume of a regular tetrahedron over its edge cubed
# Measured on boxes. fTetWild also meshes a margin around the box of the surfaces, with shorter edges near them.
NUMBER_OVER_REGULAR = {"tetwild": 2.0, "gmsh": 1.2}
BYTES_PER_TETRAHEDRON = {"tetwild": 1000.0, "gmsh": 1000.0}
MANY = 1_000_000  # more than robots of this program are usually solved with


def expected_tetrahedra(surfaces: Sequence[Surface], edge_length: float, backend: str) -> float:
    """About how many tetrahedra of this edge length fill what the mesher meshes: fTetWild the box around all surfaces,
    gmsh the body. Near surfaces there may be more of them."""
    if backend == "tetwild":
        corners = np.concatenate([surface.vertices for surface in surfaces])
        volume = float(np.prod(np.ptp(corners, axis=0)))
    else:
        volume = abs(surfaces[0].volume)
    return NUMBER_OVER_REGULAR[backend] * volume / (REGULAR * edge_length**3)


def counted(count: float) -> str:
    """'12 million', '340,000': to two digits."""
    if count < 1:
        return "1"
    rounded = float(f"{count:.1e}")
    if rounded >= 1e15:
        return f"{rounded:.0e}".replace("e+", "e")
    if rounded >= 1e9:
        return f"{rounded / 1e9:,.3g} billion"
    return f"{rounded / 1e6:.3g} million" if rounded >= 1e6 else f"{rounded:,.0f}"


def check_size(surfaces: Sequence[Surface], edge_length: float, backend: str, coarsen: bool) -> float:
    """The expected number of tetrahedra. Throws InvalidInput, before any work, where they do not fit into the memory."""
    expected = expected_tetrahedra(surfaces, edge_length, backend)
    needed, free = expected * BYTES_PER_TETRAHEDRON[backend], _core.free_memory_bytes()
    body = surfaces[0]
    size = " x ".join(f"{length:.3g}" for length in body.size)
    message = f"edge_length={edge_length:g} mm for a body of {size} mm makes about {counted(expected)} tetrahedra"
    if needed > free:
        raise InvalidInput(
            f"{message}, which take about {_core.memory_text(needed)} of memory to make, and"
            f" {_core.memory_text(free)} are free: take a longer edge, such as"
            f" {suggested_edge(surfaces, backend):.2g} mm"
        )
    if expected > MANY and not coarsen:
        warnings.warn(
            f"{message}, which takes long, and few machines solve for so many: an edge of"
            f" {suggested_edge(surfaces, backend):.2g} mm makes about 30,000",
            MeshWarning,
            stacklevel=4,
        )
    return expected


def suggested_edge(surfaces: Sequence[Surface], backend: str) -> float:
    """Of about 30,000 tetrahedra [mm]."""
    return float((expected_tetrahedra(surfaces, 1.0, backend) / 30_000) ** (1 / 3))
