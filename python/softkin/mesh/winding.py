"""Winding numbers of surfaces around points: 1 inside, 0 outside, between where a surface is not closed.

Jacobson, Kavan, Sorkine-Hornung, Robust inside-outside segmentation using generalized winding numbers, 2013; groups of
triangles far away count as one dipole: Barill et al., Fast winding numbers for soups and clouds, 2018.
"""

from __future__ import annotations

import numpy as np

from .arrays import Array
from .surface import Surface
from .triangle_tree import Node, TriangleTree

FAR = 2.5  # radii of a group; the dipole then errs by less than 0.03 in all of what it is compared with here
PAIRS = 200_000  # points times triangles that are worked on at once


def winding_numbers(surface: Surface, points: Array, far: float = FAR) -> Array:
    """Winding number of the surface around each of the points.

    points: (q, 3), mm. far: how many radii away a group of triangles is one dipole; `numpy.inf`: never.
    Returns (q,). Points on the surface itself get some number between those of its two sides.
    """
    points = np.ascontiguousarray(points, dtype=np.float64)
    tree = TriangleTree(surface.corners)
    angles = np.zeros(len(points))
    waiting: list[tuple[Node, Array]] = [(tree.root, np.arange(len(points)))]
    while waiting:
        node, indices = waiting.pop()
        away = points[indices] - node.centre
        squared = (away**2).sum(axis=1)
        distant = squared > (far * node.radius) ** 2
        if distant.any():
            one = indices[distant]
            angles[one] += -(away[distant] @ node.normal) / squared[distant] ** 1.5
        near = indices[~distant]
        if len(near) == 0:
            continue
        if node.children is None:
            angles[near] += _solid_angles(points[near], tree.corners[node.triangles])
        else:
            waiting += [(child, near) for child in node.children]
    return angles / (4 * np.pi)


def _solid_angles(points: Array, corners: Array) -> Array:
    """Sum of the solid angles of triangles (k, 3, 3) seen from points (q, 3): Van Oosterom, Strackee 1983, eq. (8)."""
    total = np.empty(len(points))
    step = max(1, PAIRS // len(corners))
    for begin in range(0, len(points), step):
        seen = corners[None] - points[begin : begin + step, None, None]
        a, b, c = seen[:, :, 0], seen[:, :, 1], seen[:, :, 2]
        la, lb, lc = np.moveaxis(np.sqrt((seen**2).sum(axis=3)), 2, 0)
        product = (a * np.cross(b, c)).sum(axis=2)
        scale = la * lb * lc + (a * b).sum(axis=2) * lc + (b * c).sum(axis=2) * la + (c * a).sum(axis=2) * lb
        total[begin : begin + step] = 2 * np.arctan2(product, scale).sum(axis=1)
    return total
