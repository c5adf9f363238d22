"""How good tetrahedra are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import Array
from .elements import face_pairs, signed_volumes
from .repair import components

EDGES = ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 0, 2), (2, 3, 0, 1))  # edge, the other two


@dataclass(frozen=True)
class Quality:
    """vertices, elements: counts. inverted: elements of no or negative volume. least_angle_deg: the smallest dihedral
    angle, degrees; angle_1_percent_deg: 1 % of the elements have a smaller one. largest_aspect: longest edge over
    shortest height, 1.22 for a regular tetrahedron. edge_median_mm: median length of edges, mm. parts: how many pieces
    hang together by faces."""

    vertices: int
    elements: int
    inverted: int
    least_angle_deg: float
    angle_1_percent_deg: float
    largest_aspect: float
    edge_median_mm: float
    parts: int

    def __str__(self) -> str:
        return (
            f"quality: least dihedral angle {self.least_angle_deg:.3g} degrees (99 % above"
            f" {self.angle_1_percent_deg:.3g}), largest aspect {self.largest_aspect:.3g}, {self.inverted} inverted;"
            f" edges {self.edge_median_mm:.3g} mm (median); {self.parts} part{'s' if self.parts > 1 else ''}"
        )


def quality_of(vertices: Array, tetrahedra: Array) -> Quality:
    angles = dihedral_angles(vertices, tetrahedra).min(axis=1)
    corners = vertices[tetrahedra]
    lengths = np.stack([np.linalg.norm(corners[:, i] - corners[:, j], axis=1) for i, j, _, _ in EDGES], axis=1)
    volumes = signed_volumes(vertices, tetrahedra)
    areas = np.stack([_area(np.delete(corners, i, axis=1)) for i in range(4)], axis=1)
    heights = 3 * np.abs(volumes) / np.maximum(areas.max(axis=1), 1e-300)
    return Quality(
        vertices=len(vertices),
        elements=len(tetrahedra),
        inverted=int((volumes <= 0).sum()),
        least_angle_deg=float(angles.min()),
        angle_1_percent_deg=float(np.percentile(angles, 1)),
        largest_aspect=float((lengths.max(axis=1) / np.maximum(heights, 1e-300)).max()),
        edge_median_mm=float(np.median(lengths)),
        parts=count_parts(tetrahedra),
    )


def dihedral_angles(vertices: Array, tetrahedra: Array) -> Array:
    """(m, 6), degrees."""
    corners = vertices[tetrahedra]
    angles = np.empty((len(tetrahedra), 6))
    for column, (i, j, k, other) in enumerate(EDGES):
        edge = corners[:, j] - corners[:, i]
        one = np.cross(edge, corners[:, k] - corners[:, i])
        two = np.cross(edge, corners[:, other] - corners[:, i])
        angles[:, column] = np.degrees(np.arctan2(np.linalg.norm(np.cross(one, two), axis=1), (one * two).sum(axis=1)))
    return angles


def count_parts(tetrahedra: Array) -> int:
    """Pieces that hang together by faces."""
    _, first, second = face_pairs(tetrahedra)
    inner = second >= 0
    alone = np.arange(len(tetrahedra))
    pairs = np.concatenate([np.stack([alone, alone], axis=1), np.stack([first[inner], second[inner]], axis=1)])
    return int(components(pairs, len(tetrahedra)).max()) + 1


def _area(corners: Array) -> Array:
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.linalg.norm(across, axis=1) / 2)
