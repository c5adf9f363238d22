"""Tetrahedra with named regions, and how good they are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .arrays import Array, Floats, Indices
from .errors import InvalidInput
from .surface import Surface

if TYPE_CHECKING:
    import meshio
    import pyvista

    from .quality import Quality

FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])  # normals outwards where the volume is positive


@dataclass(frozen=True)
class Volume:
    """Volume inside a surface that was given: of the mesh, and of the surface itself, mm^3."""

    mesh_mm3: float
    surface_mm3: float


@dataclass(frozen=True)
class VolumeMesh:
    """A mesh of tetrahedra with named regions, lengths in mm.

    vertices: (n, 3) float64. tetrahedra: (m, 4) int64, of positive volume. volume_regions: name to indices of
    tetrahedra, (e,). face_regions: name to triangles, (k, 3) vertices each. What `from_surfaces` tells:
    `volumes` inside each surface; `deviation_mm`, the largest distance between each surface that was given and that of
    the mesh, either way, sampled; `tolerance_mm`, which was asked for; `notes`.
    """

    vertices: Floats
    tetrahedra: Indices
    volume_regions: Mapping[str, Indices] = field(default_factory=dict)
    face_regions: Mapping[str, Indices] = field(default_factory=dict)
    volumes: Mapping[str, Volume] = field(default_factory=dict)
    deviation_mm: Mapping[str, float] = field(default_factory=dict)
    tolerance_mm: float = 0.0
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        vertices = np.ascontiguousarray(self.vertices, dtype=np.float64)
        tetrahedra = np.ascontiguousarray(self.tetrahedra, dtype=np.int64)
        if vertices.ndim != 2 or vertices.shape[1] != 3 or not np.isfinite(vertices).all():
            raise InvalidInput(f"vertices of shape {vertices.shape}: give (n, 3) of finite numbers, in mm")
        if tetrahedra.ndim != 2 or tetrahedra.shape[1] != 4 or len(tetrahedra) == 0:
            raise InvalidInput(f"tetrahedra of shape {tetrahedra.shape}: give (m, 4), m > 0")
        _check_indices("tetrahedra", tetrahedra, len(vertices))
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "tetrahedra", tetrahedra)
        elements = {name: np.unique(np.asarray(region, dtype=np.int64)) for name, region in self.volume_regions.items()}
        faces = {name: np.asarray(region, dtype=np.int64).reshape(-1, 3) for name, region in self.face_regions.items()}
        for name, region in elements.items():
            _check_indices(f"region '{name}'", region, len(tetrahedra))
        for name, region in faces.items():
            _check_indices(f"region '{name}'", region, len(vertices))
            if name in elements:
                raise InvalidInput(f"region '{name}' is one of elements and one of faces; give them different names")
        object.__setattr__(self, "volume_regions", elements)
        object.__setattr__(self, "face_regions", faces)

    def __repr__(self) -> str:
        names = ", ".join(self.regions)
        return (
            f"VolumeMesh({len(self.vertices)} vertices, {len(self.tetrahedra)} tetrahedra, regions: {names or 'none'})"
        )

    @property
    def regions(self) -> dict[str, Indices]:
        """All regions: of elements (e,), of faces (k, 3)."""
        return {**self.volume_regions, **self.face_regions}

    @property
    def element_volumes(self) -> Floats:
        """Volumes of the tetrahedra, (m,), mm^3."""
        return signed_volumes(self.vertices, self.tetrahedra)

    @property
    def quality(self) -> Quality:
        """Least angles, aspects and counts."""
        from .quality import quality_of

        return quality_of(self.vertices, self.tetrahedra)

    def boundary(self, *names: str) -> Surface:
        """Surface of the named volume regions together, or of the whole mesh, normals outwards."""
        chosen = self.tetrahedra
        if names:
            for name in names:
                if name not in self.volume_regions:
                    raise InvalidInput(
                        f"no volume region '{name}'; there are: {', '.join(self.volume_regions) or 'none'}"
                    )
            chosen = self.tetrahedra[np.unique(np.concatenate([self.volume_regions[name] for name in names]))]
        return Surface(self.vertices, boundary_faces(chosen), " and ".join(names) or "mesh")

    def summary(self) -> str:
        """What was made and how good it is, in lines."""
        lines = [f"{len(self.vertices)} vertices, {len(self.tetrahedra)} tetrahedra", str(self.quality)]
        volumes = self.element_volumes
        for name, region in self.volume_regions.items():
            lines.append(f"region {name}: {len(region)} tetrahedra, {volumes[region].sum():.6g} mm^3")
        lines += [f"region {name}: {len(region)} faces" for name, region in self.face_regions.items()]
        for name, deviation in self.deviation_mm.items():
            sizes = self.volumes[name]
            lines.append(
                f"surface {name}: within {deviation:.3g} mm of that of the mesh (tolerance {self.tolerance_mm:.3g} mm);"
                f" inside {sizes.mesh_mm3:.6g} mm^3 of {sizes.surface_mm3:.6g}"
            )
        return "\n".join(lines + list(self.notes))

    def write(self, path: str | Path) -> None:
        """Writes Gmsh .msh 4.1, binary, regions as physical groups."""
        from .msh_write import write_msh

        write_msh(path, self)

    def to_meshio(self) -> meshio.Mesh:
        from .neighbours import to_meshio

        return to_meshio(self)

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        from .neighbours import to_pyvista

        return to_pyvista(self)

    @staticmethod
    def from_meshio(mesh: meshio.Mesh) -> VolumeMesh:
        from .neighbours import from_meshio

        return from_meshio(mesh)

    @staticmethod
    def from_pyvista(grid: pyvista.UnstructuredGrid) -> VolumeMesh:
        from .neighbours import from_pyvista

        return from_pyvista(grid)


def signed_volumes(vertices: Array, tetrahedra: Array) -> Floats:
    a, b, c, d = np.moveaxis(vertices[tetrahedra], 1, 0)
    volumes: Floats = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6
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


def compacted(vertices: Array, tetrahedra: Array) -> tuple[Array, Array]:
    """Without the vertices that no tetrahedron has."""
    used, renumbered = np.unique(tetrahedra, return_inverse=True)
    return vertices[used], renumbered.reshape(-1, 4)


def _check_indices(what: str, indices: Array, count: int) -> None:
    if indices.size and (indices.min() < 0 or indices.max() >= count):
        raise InvalidInput(
            f"{what}: index {int(indices.min() if indices.min() < 0 else indices.max())} is not in 0 to {count - 1}"
        )
