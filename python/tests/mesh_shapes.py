"""Surfaces for the tests of softkin.mesh, and the command softkin."""

from __future__ import annotations

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from softkin.mesh import Surface

WITHOUT_TETWILD = importlib.util.find_spec("pytetwild") is None
needs_tetwild = pytest.mark.skipif(WITHOUT_TETWILD, reason="pytetwild, of the extra mesh, is not installed")
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def box(low, high, name="box"):
    """12 triangles."""
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * (high - low) + low
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Surface(corners, np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]), name)


def fine_box(low, high, divisions, name="box"):
    """Each triangle of a box in divisions^2."""
    coarse = box(low, high, name)
    points, triangles = [], []
    for corners in coarse.corners:
        index = {}
        for i in range(divisions + 1):
            for j in range(divisions + 1 - i):
                index[i, j] = len(points)
                points.append(
                    corners[0] + (corners[1] - corners[0]) * i / divisions + (corners[2] - corners[0]) * j / divisions
                )
        for i, j in index:
            if i + j < divisions:
                triangles.append((index[i, j], index[i + 1, j], index[i, j + 1]))
            if i + j < divisions - 1:
                triangles.append((index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]))
    return Surface(np.round(points, 9), np.array(triangles), name).merged()


def sphere(radius, centre=(0, 0, 0), rings=16, name="sphere"):
    """A sphere whose corners lie on the radius."""
    polar, around = np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, 2 * rings, endpoint=False)
    points = (
        [[0, 0, 1]]
        + [[np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)] for p in polar[1:-1] for a in around]
        + [[0, 0, -1]]
    )
    n, last = 2 * rings, 1 + (rings - 1) * 2 * rings
    triangles = [(0, 1 + k, 1 + (k + 1) % n) for k in range(n)]
    for ring in range(rings - 2):
        for k in range(n):
            a, b = 1 + ring * n + k, 1 + ring * n + (k + 1) % n
            triangles += [(a, a + n, b), (b, a + n, b + n)]
    triangles += [(last, last - n + (k + 1) % n, last - n + k) for k in range(n)]
    return Surface(np.array(points) * radius + np.array(centre, dtype=float), np.array(triangles), name)


def joined(*surfaces, name="joined"):
    offsets = np.cumsum([0] + [len(s.vertices) for s in surfaces])
    triangles = np.concatenate([s.triangles + offset for s, offset in zip(surfaces, offsets)])
    return Surface(np.concatenate([s.vertices for s in surfaces]), triangles, name)


def turned(surface, which=slice(None)):
    triangles = surface.triangles.copy()
    triangles[which] = triangles[which][:, [0, 2, 1]]
    return Surface(surface.vertices, triangles, surface.name)


def softkin_command():
    """The program of the same build: of the environment, or named by SOFTKIN_COMMAND."""
    found = os.environ.get("SOFTKIN_COMMAND") or shutil.which("softkin", path=str(Path(sys.executable).parent))
    assert found, "no softkin beside this Python, and SOFTKIN_COMMAND is not set"
    return found


def run_softkin(*arguments, cwd=None):
    return subprocess.run(
        [softkin_command(), *map(str, arguments)], cwd=cwd, capture_output=True, text=True, check=False
    )


def check_usable(mesh, folder):
    """Whether softkin finds nothing wrong with a mesh."""
    mesh.write(folder / "checked.msh")
    done = run_softkin("mesh", "check", folder / "checked.msh", "--json")
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout)
