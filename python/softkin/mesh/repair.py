"""Surfaces as they come: flipped faces, shells inside out, holes."""

from __future__ import annotations

import warnings
from collections import defaultdict

import numpy as np

from .arrays import Array
from .errors import MeshWarning
from .surface import Surface
from .winding import winding_numbers

WELD = 1e-5  # of the diagonal: about what single precision leaves of a coordinate far from the origin
ENCLOSING = 20  # only the largest shells are tested for enclosing others
LARGE_HOLE = 0.05  # of the surface's area; more than that is rather a missing part


def repaired(surface: Surface) -> Surface:
    """Points at gaps joined, faces turned to agree with their neighbours, holes closed, shells turned as
    `_shells_turned` says; `notes` lists the repairs. Overlaps and self-intersections stay: winding numbers tolerate
    them."""
    surface = _holes_closed(_faces_turned(_welded(surface)))
    return _shells_turned(surface)


def open_edges(surface: Surface) -> Array:
    """Edges of one triangle only, (e, 2), in its direction."""
    edges = _directed_edges(surface.triangles)
    _, which, counts = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    alone: Array = edges[counts[which.reshape(-1)] == 1]
    return alone


def components(cells: Array, count: int) -> Array:
    """Number of the connected part of each of the cells, (k,), of which each names some of `count` vertices."""
    return np.unique(_least(cells, count)[cells[:, 0]], return_inverse=True)[1].reshape(-1)


def shell_volumes(surface: Surface) -> tuple[Array, Array]:
    """The shell of each triangle, (k,), and the signed volumes of the shells, mm^3."""
    shell = components(surface.triangles, len(surface.vertices))
    corners = surface.corners
    counts = np.bincount(shell)[:, None]
    middles = np.stack([np.bincount(shell, weights=corners[:, :, axis].mean(axis=1)) for axis in range(3)], axis=1)
    away = corners - (middles / counts)[shell][:, None]
    cones = np.einsum("ij,ij->i", away[:, 0], np.cross(away[:, 1], away[:, 2])) / 6
    return shell, np.bincount(shell, weights=cones)


def _least(cells: Array, count: int) -> Array:
    """The least vertex of the connected part of each vertex, (count,)."""
    label = np.arange(count)
    while True:  # the least label of each cell spreads, and labels point ever further down
        least = label[cells].min(axis=1)
        before = label.copy()
        np.minimum.at(label, cells.reshape(-1), np.repeat(least, cells.shape[1]))
        label = label[label]
        if np.array_equal(label, before):
            return label


def _welded(surface: Surface) -> Surface:
    """Points at open edges that are nearly at the same place made one."""
    loose = np.unique(open_edges(surface))
    if len(loose) == 0:
        return surface
    cell = WELD * surface.diagonal
    links = [np.stack([loose, loose], axis=1)]
    for shift in np.ndindex(2, 2, 2):  # points within half a cell fall into one cell for some shift
        places = np.floor(surface.vertices[loose] / cell + np.array(shift) / 2)
        _, first, which = np.unique(places, axis=0, return_index=True, return_inverse=True)
        links.append(np.stack([loose, loose[first[which.reshape(-1)]]], axis=1))
    label = _least(np.concatenate(links), len(surface.vertices))
    moved = int((label != np.arange(len(label))).sum())
    if moved == 0:
        return surface
    note = f"{surface.name}: {moved} points joined to others within {cell:.2g} mm"
    return surface.with_triangles(label[surface.triangles], note).merged()


def _directed_edges(triangles: Array) -> Array:
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def _faces_turned(surface: Surface) -> Surface:
    triangles = surface.triangles.copy()
    edges = _directed_edges(triangles)
    owner = np.tile(np.arange(len(triangles)), 3)
    key, which, counts = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(which.reshape(-1), kind="stable")
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])[counts == 2]
    first, second = order[starts], order[starts + 1]
    against = (edges[first] == edges[second]).all(
        axis=1
    )  # neighbours that agree run along their edge in opposite directions
    if not against.any():
        return surface
    neighbours: dict[int, list[tuple[int, bool]]] = defaultdict(list)
    for a, b, differs in zip(owner[first].tolist(), owner[second].tolist(), against.tolist()):
        neighbours[a].append((b, differs))
        neighbours[b].append((a, differs))
    areas = np.linalg.norm(surface.normals, axis=1)
    turned = np.full(len(triangles), -1)
    for seed in range(len(triangles)):
        if turned[seed] < 0:
            patch = _spread(seed, neighbours, turned)
            # the larger part of the area keeps its orientation
            if areas[patch[turned[patch] == 1]].sum() > areas[patch].sum() / 2:
                turned[patch] ^= 1
    flipped = turned == 1
    triangles[flipped] = triangles[flipped][:, [0, 2, 1]]
    return surface.with_triangles(
        triangles, f"{surface.name}: {int(flipped.sum())} faces turned to agree with their neighbours"
    )


def _spread(seed: int, neighbours: dict[int, list[tuple[int, bool]]], turned: Array) -> Array:
    turned[seed] = 0
    patch = [seed]
    for face in patch:
        for other, differs in neighbours[face]:
            if turned[other] < 0:
                turned[other] = turned[face] ^ int(differs)
                patch.append(other)
    return np.array(patch)


def _holes_closed(surface: Surface) -> Surface:
    edges = open_edges(surface)
    if len(edges) == 0:
        return surface
    vertices, widest = surface.vertices, 0.0
    added: list[Array] = []
    points = [vertices]
    loops, left = _loops(edges)
    known = {tuple(corners) for corners in np.sort(surface.triangles, axis=1).tolist()}
    bounding = [
        loop for loop in loops if tuple(sorted(loop.tolist())) not in known
    ]  # others are the rim of one triangle
    left += 3 * (len(loops) - len(bounding))
    loops = bounding
    for loop in loops:
        rim = vertices[loop]
        widest = max(widest, float(np.linalg.norm(np.ptp(rim, axis=0))))
        following = np.roll(loop, -1)
        if len(loop) == 3:
            added.append(loop[None, [1, 0, 2]])
            continue
        middle = len(vertices) + sum(len(block) for block in points[1:])
        points.append(rim.mean(axis=0, keepdims=True))
        added.append(np.stack([following, loop, np.full(len(loop), middle)], axis=1))
    holes = "1 hole" if len(loops) == 1 else f"{len(loops)} holes"
    note = f"{surface.name}: {holes} closed, the widest {widest:.3g} mm across"
    if left:
        note += f"; {left} open edges that bound no hole stay"
    if not added:
        return surface.with_triangles(surface.triangles, note)
    closed = surface.with_triangles(np.concatenate([surface.triangles, *added]), note, vertices=np.concatenate(points))
    patched = np.linalg.norm(closed.normals[len(surface.triangles) :], axis=1).sum()
    if patched > LARGE_HOLE * surface.area:
        warnings.warn(
            f"{note}; they are {100 * patched / surface.area:.0f} % of its area: is a part of the surface missing?",
            MeshWarning,
            stacklevel=2,
        )
    return closed


def _loops(edges: Array) -> tuple[list[Array], int]:
    """Returns the closed loops of directed edges, and the number of edges that are in none."""
    following: dict[int, list[int]] = defaultdict(list)
    for start, end in edges.tolist():
        following[start].append(end)
    loops, left = [], 0
    for start in [edge[0] for edge in edges.tolist()]:
        path, place = [start], {start: 0}
        while following[path[-1]]:
            vertex = following[path[-1]].pop()
            if vertex in place:  # a loop; where two touch in a vertex, each is one of its own
                loop = path[place[vertex] :]
                loops.append(np.array(loop))
                for gone in loop[1:]:
                    del place[gone]
                path = path[: place[vertex] + 1]
            else:
                place[vertex] = len(path)
                path.append(vertex)
        left += len(path) - 1
    return [loop for loop in loops if len(loop) >= 3], left


def _shells_turned(surface: Surface) -> Surface:
    """Shells keep the direction that they have relative to the largest, so that a cavity that turns inwards stays one;
    all are turned where the largest is inside out, and those that turn inwards without being inside another."""
    shell, volumes = shell_volumes(surface)
    by_size = np.argsort(-np.abs(volumes))
    turn = np.full(len(volumes), bool(volumes[by_size[0]] < 0))
    inwards = np.flatnonzero(np.where(turn, -volumes, volumes) < 0)
    points = surface.corners[np.unique(shell, return_index=True)[1][inwards]].mean(axis=1)  # one of each of them
    enclosed = np.zeros(len(inwards), dtype=bool)
    for outer in by_size[:ENCLOSING]:
        of_it = surface.with_triangles(surface.triangles[shell == outer])
        others = inwards != outer
        enclosed[others] |= np.abs(winding_numbers(of_it, points[others])) > 0.5
    turn[inwards[~enclosed]] ^= True
    if not turn.any():
        return surface
    flipped = turn[shell]
    triangles = surface.triangles.copy()
    triangles[flipped] = triangles[flipped][:, [0, 2, 1]]
    note = f"{surface.name}: {int(turn.sum())} of {len(volumes)} shells were inside out and are turned"
    return surface.with_triangles(triangles, note)
