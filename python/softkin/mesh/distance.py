"""Distances of points from surfaces."""

from __future__ import annotations

import numpy as np

from .arrays import Array
from .triangle_tree import Node, TriangleTree

PAIRS = 200_000


def distances(corners: Array, points: Array) -> Array:
    """Distance of each of the points (q, 3) from the nearest of the triangles (k, 3, 3), (q,)."""
    points = np.ascontiguousarray(points, dtype=np.float64)
    tree = TriangleTree(corners)
    best = np.full(len(points), np.inf)
    level: list[tuple[Node, Array]] = [(tree.root, np.arange(len(points)))]
    while level:
        gaps = [np.sqrt(((points[asked] - node.centre) ** 2).sum(axis=1)) for node, asked in level]
        for (node, asked), gap in zip(level, gaps):  # every group has a triangle within its ball
            best[asked] = np.minimum(best[asked], gap + node.radius)
        following = []
        for (node, asked), gap in zip(level, gaps):
            near = asked[gap - node.radius <= best[asked]]
            if len(near) and node.children is None:
                best[near] = np.minimum(best[near], _to_triangles(points[near], tree.corners[node.triangles]))
            elif len(near):
                following += [(child, near) for child in node.children or ()]
        level = following
    return best


def _to_triangles(points: Array, corners: Array) -> Array:
    least = np.empty(len(points))
    step = max(1, PAIRS // len(corners))
    for begin in range(0, len(points), step):
        least[begin : begin + step] = _pairwise(points[begin : begin + step, None], corners[None]).min(axis=1)
    return least


def _pairwise(points: Array, corners: Array) -> Array:
    """Distances (q, k): that from the plane where the foot is inside the triangle, else that from its nearest edge."""
    normal = np.cross(corners[..., 1, :] - corners[..., 0, :], corners[..., 2, :] - corners[..., 0, :])
    squared = np.maximum((normal**2).sum(axis=-1), 1e-300)
    inside = np.ones(np.broadcast_shapes(points.shape[:2], corners.shape[:2]), dtype=bool)
    nearest = np.full(inside.shape, np.inf)
    for one, two in ((0, 1), (1, 2), (2, 0)):
        edge = corners[..., two, :] - corners[..., one, :]
        offset = points - corners[..., one, :]
        along = (offset * edge).sum(axis=-1) / np.maximum((edge**2).sum(axis=-1), 1e-300)
        rest = offset - np.clip(along, 0, 1)[..., None] * edge
        nearest = np.minimum(nearest, (rest**2).sum(axis=-1))
        inside &= (np.cross(edge, offset) * normal).sum(axis=-1) >= 0
    height = ((points - corners[..., 0, :]) * normal).sum(axis=-1) ** 2 / squared
    return np.sqrt(np.where(inside, height, nearest))
