"""Elements, their faces and volumes, and meshes of them as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from .arrays import Array, Floats, Indices
from .errors import InvalidInput
from .triangles import Surface

FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])  # normals outwards where the volume is positive


@dataclass(frozen=True)
class Volume:
    """Volume inside a surface that was given: of the mesh, and of the surface itself, mm^3."""

    mesh_mm3: float
    surface_mm3: float


@dataclass(frozen=True)
class MeshData:
    """What a VolumeMesh holds, checked."""

    vertices: Floats
    tetrahedra: Indices
    volume_regions: Mapping[str, Indices] = field(default_factory=dict)
    face_regions: Mapping[str, Indices] = field(default_factory=dict)
    volumes: Mapping[str, Volume] = field(default_factory=dict)
    deviation_mm: Mapping[str, float] = field(default_factory=dict)
    tolerance_mm: float = 0.0
    notes: tuple[str, ...] = ()
    prisms: Indices = field(default_factory=lambda: np.empty((0, 6), dtype=np.int64))

    def __post_init__(self) -> None:
        vertices = np.ascontiguousarray(self.vertices, dtype=np.float64)
        tetrahedra = np.ascontiguousarray(self.tetrahedra, dtype=np.int64)
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
            raise InvalidInput(f"vertices of shape {vertices.shape}: give (n, 3) of finite numbers, in mm")
        prisms = np.ascontiguousarray(self.prisms, dtype=np.int64)
        if prisms.ndim != 2 or prisms.shape[1] != 6:
            raise InvalidInput(f"prisms of shape {prisms.shape}: give (p, 6)")
        if tetrahedra.ndim != 2 or tetrahedra.shape[1] != 4 or len(tetrahedra) + len(prisms) == 0:
            raise InvalidInput(f"tetrahedra of shape {tetrahedra.shape}: give (m, 4), m > 0")
        _check_indices("tetrahedra", tetrahedra, len(vertices))
        _check_indices("prisms", prisms, len(vertices))
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "tetrahedra", tetrahedra)
        object.__setattr__(self, "prisms", prisms)
        elements = {name: np.unique(np.asarray(region, dtype=np.int64)) for name, region in self.volume_regions.items()}
        faces = {name: np.asarray(region, dtype=np.int64).reshape(-1, 3) for name, region in self.face_regions.items()}
        for name, region in elements.items():
            _check_indices(f"region '{name}'", region, len(tetrahedra) + len(prisms))
        for name, region in faces.items():
            _check_indices(f"region '{name}'", region, len(vertices))
            if name in elements:
                raise InvalidInput(f"region '{name}' is one of elements and one of faces; give them different names")
        object.__setattr__(self, "volume_regions", elements)
        object.__setattr__(self, "face_regions", faces)

    @property
    def regions(self) -> dict[str, Indices | dict[str, Indices]]:
        """All regions, as softkin.Robot takes them: of elements (e,), or where there are prisms
        {"tetrahedra": (e,), "prisms": (q,)}; of faces (k, 3)."""
        elements: dict[str, Indices | dict[str, Indices]] = dict(self.volume_regions)
        if len(self.prisms):
            elements = {name: self._parts(region) for name, region in self.volume_regions.items()}
        return {**elements, **self.face_regions}

    def _parts(self, region: Indices) -> dict[str, Indices]:
        """The numbers of its tetrahedra and of its prisms."""
        first = len(self.tetrahedra)
        return {"tetrahedra": region[region < first], "prisms": region[region >= first] - first}

    @property
    def element_volumes(self) -> Floats:
        """Volumes of the tetrahedra, then of the prisms, (m + p,), mm^3."""
        tetrahedra = signed_volumes(self.vertices, self.tetrahedra)
        return np.concatenate([tetrahedra, prism_volumes(self.vertices, self.prisms)])

    def boundary(self, *names: str) -> Surface:
        """Surface of the named volume regions together, or of the whole mesh, normals outwards; four-sided faces of
        prisms as two triangles."""
        tetrahedra, prisms = self.tetrahedra, self.prisms
        if names:
            for name in names:
                if name not in self.volume_regions:
                    raise InvalidInput(
                        f"no volume region '{name}'; there are: {', '.join(self.volume_regions) or 'none'}"
                    )
            chosen = self._parts(np.unique(np.concatenate([self.volume_regions[name] for name in names])))
            tetrahedra, prisms = tetrahedra[chosen["tetrahedra"]], prisms[chosen["prisms"]]
        return Surface(self.vertices, outer_faces(tetrahedra, prisms), " and ".join(names) or "mesh")


def signed_volumes(vertices: Array, tetrahedra: Array) -> Floats:
    a, b, c, d = np.moveaxis(vertices[tetrahedra], 1, 0)
    volumes: Floats = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6
    return volumes


def prism_volumes(vertices: Array, prisms: Array) -> Floats:
    """Of wedges with straight edges, whose four-sided faces may be warped: exact, by the three-point rule in the
    triangle and Gauss' rule of two points along the thickness."""
    corners = vertices[prisms]
    bottom, top = corners[:, :3], corners[:, 3:]
    volumes: Floats = np.zeros(len(prisms))
    for zeta in (0.5 - 0.5 / np.sqrt(3), 0.5 + 0.5 / np.sqrt(3)):
        middle = (1 - zeta) * bottom + zeta * top
        normal = np.cross(middle[:, 1] - middle[:, 0], middle[:, 2] - middle[:, 0]) / 2
        volumes += np.einsum("ij,ij->i", normal, (top - bottom).mean(axis=1)) / 2
    return volumes


def positive(vertices: Array, tetrahedra: Array) -> Array:
    """The tetrahedra with the corners of those of negative volume reordered."""
    reversed_ones = signed_volumes(vertices, tetrahedra) < 0
    ordered = tetrahedra.copy()
    ordered[reversed_ones] = ordered[reversed_ones][:, [0, 2, 1, 3]]
    return ordered


def face_pairs(tetrahedra: Array) -> tuple[Array, Array, Array]:
    """Every face once, (f, 3), as the first of its tetrahedra sees it from inside; the numbers of its first and its
    second tetrahedron, (f,) each, -1 where there is no second."""
    faces = tetrahedra[:, FACES].reshape(-1, 3)
    _, first, which = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_inverse=True)
    second = np.full(len(first), -1)
    later = np.ones(len(faces), dtype=bool)
    later[first] = False
    second[which.reshape(-1)[later]] = np.flatnonzero(later) // 4
    return faces[first], first // 4, second


def boundary_faces(tetrahedra: Array) -> Array:
    """Faces of one tetrahedron only, normals outwards, (k, 3)."""
    faces, _, second = face_pairs(tetrahedra)
    return faces[second < 0]


def outer_faces(tetrahedra: Array, prisms: Array) -> Array:
    """Faces of one element only, normals outwards, (k, 3). Four-sided ones are two triangles, split from the corner of
    the lowest number, so that two prisms agree."""
    triangles = [tetrahedra[:, FACES].reshape(-1, 3), prisms[:, [0, 2, 1]], prisms[:, [3, 4, 5]]]
    for quad in ((0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)):
        corners = prisms[:, quad]
        turned = np.take_along_axis(corners, (corners.argmin(axis=1)[:, None] + np.arange(4)) % 4, axis=1)
        triangles += [turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]]
    every = np.concatenate(triangles)
    _, first, count = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
    faces: Indices = every[np.sort(first[count == 1])]
    return faces


def renumbering(count: int, *cells: Array) -> Array:
    """The numbers of vertices where only those of the cells are left, (count,); -1: of none."""
    used = np.unique(np.concatenate([block.ravel() for block in cells]))
    number = np.full(count, -1)
    number[used] = np.arange(len(used))
    return number


def compacted(vertices: Array, tetrahedra: Array) -> tuple[Array, Array]:
    """Without the vertices that no tetrahedron has."""
    used, renumbered = np.unique(tetrahedra, return_inverse=True)
    return vertices[used], renumbered.reshape(-1, 4)


def check_name(name: str) -> None:
    """Throws InvalidInput where a name cannot be one of a region in a scene."""
    if not isinstance(name, str) or not name or name == "all" or any(c in ',="#' or c.isspace() for c in name):
        raise InvalidInput(
            f"{name!r} is no name of a region: letters without blanks, ',', '=', '\"' and '#', and not 'all'"
        )


def _check_indices(what: str, indices: Array, count: int) -> None:
    if indices.size and (indices.min() < 0 or indices.max() >= count):
        raise InvalidInput(
            f"{what}: index {int(indices.min() if indices.min() < 0 else indices.max())} is not in 0 to {count - 1}"
        )
