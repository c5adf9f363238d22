"""The mesher of messy surfaces: fTetWild by pytetwild (MPL-2.0)."""

from __future__ import annotations

from typing import Any

import numpy as np

from .arrays import Array
from .errors import InvalidInput
from .surface import Surface

# Ten rounds leave the angles that eighty do, in a third of the time.
ROUNDS = 10
INSTALL = (
    "softkin.mesh needs pytetwild: pip install 'softkin[mesh]' (or: pip install 'pytetwild[all]'); or take"
    " backend='gmsh'"
)


def import_pytetwild() -> Any:
    """pytetwild, which needs PyVista to be imported. Throws ImportError that says how to install them."""
    try:
        import pytetwild
    except ImportError as error:
        raise ImportError(f"{INSTALL} ({error})") from None
    return pytetwild


def background(surfaces: list[Surface], edge_length: float, tolerance: float, coarsen: bool) -> tuple[Array, Array]:
    """Tetrahedra of the box around all surfaces, with faces along each of them.

    edge_length, tolerance: mm. coarsen: as few tetrahedra as their shapes allow. Returns (n, 3), (m, 4) without order
    of corners. Hu et al., Fast tetrahedral meshing in the wild, 2020. Throws InvalidInput, ImportError.
    """
    pytetwild = import_pytetwild()
    offsets = np.cumsum([0] + [len(surface.vertices) for surface in surfaces])
    vertices = np.concatenate([surface.vertices for surface in surfaces])
    triangles = np.concatenate([surface.triangles + offset for surface, offset in zip(surfaces, offsets)])
    diagonal = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    try:
        points, tetrahedra = pytetwild.tetrahedralize(
            vertices,
            triangles.astype(np.int32),
            edge_length_abs=edge_length,
            epsilon=tolerance / diagonal,
            coarsen=coarsen,
            num_opt_iter=ROUNDS,
            disable_filtering=True,  # all of the box, so that regions are told apart here
            quiet=True,
        )
    except (RuntimeError, ValueError) as error:
        names = ", ".join(surface.name for surface in surfaces)
        raise InvalidInput(f"fTetWild made no mesh of {names}: {error}") from None
    if len(tetrahedra) == 0:
        raise InvalidInput(f"fTetWild made no mesh of {', '.join(surface.name for surface in surfaces)}")
    return np.asarray(points, dtype=np.float64), np.asarray(tetrahedra, dtype=np.int64)
