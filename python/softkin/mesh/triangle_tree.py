"""A bounding-sphere tree over triangles, for queries of many points at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import Array

LEAF = 24  # triangles; smaller ones cost more calls, larger ones more pairs


@dataclass
class Node:
    """Some triangles: their numbers, a ball around them, and their area-weighted normal and middle."""

    triangles: Array
    centre: Array
    radius: float
    normal: Array
    children: tuple[Node, Node] | None


class TriangleTree:
    """Triangles, (k, 3, 3), halved at the median of their middles along the longest axis."""

    def __init__(self, corners: Array) -> None:
        self.corners = np.ascontiguousarray(corners, dtype=np.float64)
        self.middles = self.corners.mean(axis=1)
        self.normals = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0]) / 2
        self.areas = np.linalg.norm(self.normals, axis=1)
        self.root = self._node(np.arange(len(corners)))

    def _node(self, triangles: Array) -> Node:
        weights = self.areas[triangles] + 1e-300
        centre = np.average(self.middles[triangles], axis=0, weights=weights)
        radius = float(np.sqrt(((self.corners[triangles] - centre) ** 2).sum(axis=2).max()))
        children = None
        if len(triangles) > LEAF:
            middles = self.middles[triangles]
            axis = int(np.argmax(np.ptp(middles, axis=0)))
            order = triangles[np.argsort(middles[:, axis], kind="stable")]
            half = len(order) // 2
            children = (self._node(order[:half]), self._node(order[half:]))
        return Node(triangles, centre, radius, self.normals[triangles].sum(axis=0), children)
