"""A robot made of arrays: a beam of 64 x 20 x 20 mm, held at x = 0, with three chambers along it."""

from itertools import permutations

import numpy as np
from numpy.typing import NDArray

import softkin

CELLS = (5, 5, 5)
SIZE = (64.0, 20.0, 20.0)  # [mm]


def block() -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Vertices [mm] and tetrahedra, six to a cell: a path along its edges each."""
    counts = [n + 1 for n in CELLS]
    axes = [np.linspace(0, length, count) for length, count in zip(SIZE, counts)]
    vertices = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(vertices)).reshape(counts)
    corner = number[:-1, :-1, :-1].ravel()
    steps = [number[1, 0, 0], number[0, 1, 0], number[0, 0, 1]]
    tetrahedra = []
    for order in permutations(range(3)):
        a, b, c, d = (corner + sum(steps[axis] for axis in order[:i]) for i in range(4))
        turned = order in ((0, 2, 1), (2, 1, 0), (1, 0, 2))
        tetrahedra.append(np.stack([a, b, d, c] if turned else [a, b, c, d], axis=1))
    return vertices, np.concatenate(tetrahedra)


def three_chamber_beam(youngs_modulus: float = 1.0, payload_N: tuple[float, float, float] = (0, 0, 0)) -> softkin.Robot:
    """youngs_modulus: [MPa]; payload_N: a force at the end [N]"""
    vertices, tetrahedra = block()
    middle = vertices[tetrahedra].mean(axis=1)
    regions: dict[str, object] = {
        "base": {"vertices": np.flatnonzero(vertices[:, 0] == 0)},
        "end": {"vertices": np.flatnonzero(vertices[:, 0] == SIZE[0])},
    }
    for i, (y, z) in enumerate([(4, 4), (12, 4), (8, 12)], start=1):
        low, high = np.array([12, y, z]), np.array([52, y + 4, z + 4])
        regions[f"chamber{i}"] = ((middle > low) & (middle < high)).all(axis=1)
    return softkin.Robot(
        vertices,
        tetrahedra,
        order=2,
        regions=regions,
        materials=[{"youngs_modulus": youngs_modulus, "poisson_ratio": 0.4}],
        fixed=[{"region": "base"}],
        actuators=[{"name": f"air{i}", "kind": "pneumatic", "region": f"chamber{i}", "range": (1, 2)} for i in (1, 2, 3)],
        forces=[{"name": "payload", "region": "end", "force": payload_N}],
        markers={"tip": "end"},
        name="beam",
    )
