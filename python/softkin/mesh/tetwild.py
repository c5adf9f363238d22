"""The mesher of messy surfaces: fTetWild by pytetwild (MPL-2.0)."""

from __future__ import annotations

import importlib.util
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from .arrays import Array
from .child import ProgressFunction, run
from .errors import InvalidInput
from .surface import Surface

ROUNDS = 10  # of optimisation; the angles are those that 80 leave, in a third of the time
INSTALL = "pip install 'softkin[mesh]' (or: pip install pytetwild); or take backend='gmsh'"

# In a process of its own: Ctrl-C ends it, and a crash of it does not end Python. pytetwild imports PyVista,
# which is slow to load, only to add to it what is not used here: an empty module does.
SCRIPT = """
import json, sys, types
sys.modules["pyvista"] = types.ModuleType("pyvista")
import numpy, pytetwild
given = numpy.load("given.npz")
points, cells = pytetwild.tetrahedralize(given["vertices"], given["triangles"], **json.loads(sys.argv[1]))
numpy.savez("made.npz", points=points, cells=cells)
"""


def background(
    surfaces: list[Surface],
    edge_length: float,
    tolerance: float,
    coarsen: bool,
    what: str,
    progress: ProgressFunction | None,
) -> tuple[Array, Array]:
    """Tetrahedra of the box around all surfaces, with faces along each of them.

    edge_length, tolerance: mm. coarsen: as few tetrahedra as their shapes allow. what: is done, for progress. Returns (n, 3), (m, 4) without order
    of corners. Hu et al., Fast tetrahedral meshing in the wild, 2020. Throws InvalidInput, ImportError.
    """
    _check_installed()
    offsets = np.cumsum([0] + [len(surface.vertices) for surface in surfaces])
    vertices = np.concatenate([surface.vertices for surface in surfaces])
    triangles = np.concatenate([surface.triangles + offset for surface, offset in zip(surfaces, offsets)])
    options = {
        "edge_length_abs": edge_length,
        "epsilon": tolerance / float(np.linalg.norm(np.ptp(vertices, axis=0))),
        "coarsen": coarsen,
        "num_opt_iter": ROUNDS,
        "disable_filtering": True,  # keep the whole box: the regions are identified afterwards
        "quiet": True,
    }
    with tempfile.TemporaryDirectory() as name:
        np.savez(Path(name) / "given.npz", vertices=vertices, triangles=triangles.astype(np.int32))
        problem = _run(Path(name), options, what, progress)
        if not problem:
            with np.load(Path(name) / "made.npz") as made:
                points, cells = made["points"].astype(np.float64), made["cells"].astype(np.int64)
            problem = "" if len(cells) else "it made no tetrahedra"
    if problem:
        names = ", ".join(surface.name for surface in surfaces)
        raise InvalidInput(f"fTetWild made no mesh of {names}: {problem}; try another tolerance or edge_length")
    return points, cells


def _check_installed() -> None:
    try:
        found = importlib.util.find_spec("pytetwild")
    except ValueError:  # what sys.modules has of it is no module
        found = None
    if found is None:
        raise ImportError(f"softkin.mesh needs pytetwild, which is not installed: {INSTALL}")


def _run(
    folder: Path, options: dict[str, Any], what: str = "meshing", progress: ProgressFunction | None = None
) -> str:
    """What went wrong, or nothing."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    command = [sys.executable, "-c", SCRIPT, json.dumps(options)]
    done = run(command, folder, what, progress, environment)
    if done.returncode < 0:
        return f"it was ended by signal {-done.returncode}"
    said = done.stderr.strip().splitlines() or [f"it ended with code {done.returncode}"]
    return said[-1] if done.returncode or not (folder / "made.npz").is_file() else ""
