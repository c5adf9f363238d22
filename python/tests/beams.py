"""Robots in memory: blocks of tetrahedra with chambers."""

from __future__ import annotations

from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

import softkin


def block(cells: tuple[int, int, int], size: tuple[float, float, float]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Vertices [mm] and tetrahedra, six to a cell."""
    counts = [n + 1 for n in cells]
    grid = np.stack(np.meshgrid(*(np.linspace(0, s, n) for s, n in zip(size, counts)), indexing="ij"), axis=-1)
    number = np.arange(np.prod(counts)).reshape(counts)
    corner = number[:-1, :-1, :-1].ravel()
    steps = [int(number[1, 0, 0]), int(number[0, 1, 0]), int(number[0, 0, 1])]
    tetrahedra = []
    for order in permutations(range(3)):
        path = np.cumsum([0, *(steps[axis] for axis in order)])
        nodes = [corner + step for step in path]
        even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        tetrahedra.append(np.stack(nodes if even else [nodes[0], nodes[1], nodes[3], nodes[2]], axis=1))
    return grid.reshape(-1, 3), np.concatenate(tetrahedra)


def beam(along: int = 8, across: int = 5, **changes: Any) -> softkin.Robot:
    """64 x 20 x 20 mm along x, held at x = 0, with three chambers around its axis."""
    vertices, tetrahedra = block((along, across, across), (64, 20, 20))
    middle = vertices[tetrahedra].mean(axis=1)
    regions: dict[str, Any] = {}
    for i, (y, z) in enumerate([(4, 4), (12, 4), (8, 12)]):
        low, high = np.array([8, y, z]), np.array([56, y + 4, z + 4])
        regions[f"chamber{i + 1}"] = ((middle > low) & (middle < high)).all(axis=1)
    regions["base"] = {"vertices": np.flatnonzero(vertices[:, 0] == 0)}
    regions["end"] = {"vertices": np.flatnonzero(vertices[:, 0] == 64)}
    description: dict[str, Any] = {
        "regions": regions,
        "materials": [{"youngs_modulus": 1, "poisson_ratio": 0.4}],
        "fixed": [{"region": "base"}],
        "actuators": [
            {"name": f"air{i}", "kind": "pneumatic", "region": f"chamber{i}", "range": (1, 2)} for i in (1, 2, 3)
        ],
        "markers": {"tip": "end"},
        "name": "beam",
    }
    return softkin.Robot(vertices, tetrahedra, **{**description, **changes})
