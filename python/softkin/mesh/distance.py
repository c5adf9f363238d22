"""Distances of points from surfaces, and the nearest triangles."""

from __future__ import annotations

import numpy as np

from .arrays import Array
from .triangle_tree import Node, TriangleTree

PAIRS = 200_000


def distances(corners: Array, points: Array) -> Array:
    """Distance of each of the points (q, 3) from the nearest of the triangles (k, 3, 3), (q,)."""
    return nearest(corners, points)[0]


def nearest(corners: Array, points: Array) -> tuple[Array, Array]:
    """Distance of each of the points (q, 3) from the nearest of the triangles (k, 3, 3), (q,), and the number of that
    triangle, (q,)."""
    points = np.ascontiguousarray(points, dtype=np.float64)
    tree = TriangleTree(corners)
    bound = np.full(len(points), np.inf)
    best = np.full(len(points), np.inf)
    triangle = np.zeros(len(points), dtype=np.int64)
    level: list[tuple[Node, Array]] = [(tree.root, np.arange(len(points)))]
    while level:
        gaps = [np.sqrt(((points[indices] - node.centre) ** 2).sum(axis=1)) for node, indices in level]
        for (node, indices), gap in zip(level, gaps):  # every group has a triangle within its ball
            bound[indices] = np.minimum(bound[indices], gap + node.radius)
        following = []
        for (node, indices), gap in zip(level, gaps):
            near = indices[gap - node.radius <= bound[indices]]
            if len(near) and node.children is None:
                found, which = _nearest_of_few(points[near], tree.corners[node.triangles])
                closer = found < best[near]
                best[near[closer]] = found[closer]
                triangle[near[closer]] = node.triangles[which[closer]]
                bound[near] = np.minimum(bound[near], best[near])
            elif len(near):
                following += [(child, near) for child in node.children or ()]
        level = following
    return best, triangle


def feet(points: Array, corners: Array) -> Array:
    """Nearest points of triangles (..., 3, 3) to points (..., 3): the foot on the plane where that is inside the
    triangle, else the nearest point of an edge."""
    a = corners[..., 0, :]
    normal = np.cross(corners[..., 1, :] - a, corners[..., 2, :] - a)
    squared = np.maximum((normal**2).sum(axis=-1), 1e-300)
    foot = points - (((points - a) * normal).sum(axis=-1) / squared)[..., None] * normal
    inside = np.ones(foot.shape[:-1], dtype=bool)
    on_edge, least = foot, np.full(foot.shape[:-1], np.inf)
    for one, two in ((0, 1), (1, 2), (2, 0)):
        edge = corners[..., two, :] - corners[..., one, :]
        offset = points - corners[..., one, :]
        along = (offset * edge).sum(axis=-1) / np.maximum((edge**2).sum(axis=-1), 1e-300)
        place = corners[..., one, :] + np.clip(along, 0, 1)[..., None] * edge
        gap = ((points - place) ** 2).sum(axis=-1)
        on_edge = np.where((gap < least)[..., None], place, on_edge)
        least = np.minimum(least, gap)
        inside &= (np.cross(edge, offset) * normal).sum(axis=-1) >= 0
    return np.asarray(np.where(inside[..., None], foot, on_edge))


def _nearest_of_few(points: Array, corners: Array) -> tuple[Array, Array]:
    least, which = np.empty(len(points)), np.empty(len(points), dtype=np.int64)
    step = max(1, PAIRS // len(corners))
    for begin in range(0, len(points), step):
        block = points[begin : begin + step, None]
        gaps = ((feet(block, corners[None]) - block) ** 2).sum(axis=2)
        which[begin : begin + step] = gaps.argmin(axis=1)
        least[begin : begin + step] = np.sqrt(gaps.min(axis=1))
    return least, which
