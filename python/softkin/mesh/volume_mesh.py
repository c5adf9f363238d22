"""Tetrahedra and prisms with named regions, and how good they are."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from . import neighbours
from .elements import MeshData, Volume, boundary_faces
from .errors import InvalidInput
from .layers import upon
from .msh_write import write_msh
from .quality import Quality, quality_of

if TYPE_CHECKING:
    import meshio
    import pyvista

__all__ = ["Volume", "VolumeMesh", "boundary_faces"]


class VolumeMesh(MeshData):
    """A mesh of tetrahedra, or prisms, with named regions, lengths in mm.

    vertices: (n, 3) float64. tetrahedra: (m, 4) int64, of positive volume. prisms: (p, 6), bottom triangle, then top
    triangle, of which `stacked` makes layers. volume_regions: name to indices of elements, (e,), the tetrahedra first,
    then the prisms. face_regions: name to triangles, (k, 3) vertices each. `from_surfaces` adds `volumes`
    inside each surface; `deviation_mm`, the larger of the two sampled one-sided distances between each given surface
    and that of the mesh; the requested `tolerance_mm`; and `notes`.
    """

    def __repr__(self) -> str:
        return f"VolumeMesh({self._counts()}, regions: {', '.join(self.regions) or 'none'})"

    def _counts(self) -> str:
        kinds = [f"{len(cells)} {name}" for cells, name in ((self.tetrahedra, "tetrahedra"), (self.prisms, "prisms"))]
        return ", ".join([f"{len(self.vertices)} vertices", *(kind for kind in kinds if not kind.startswith("0 "))])

    @property
    def quality(self) -> Quality:
        """Least angles, aspects and counts of the tetrahedra. Throws InvalidInput where there are none."""
        if len(self.tetrahedra) == 0:
            raise InvalidInput("the mesh has prisms alone, and quality is that of tetrahedra")
        return quality_of(self.vertices, self.tetrahedra)

    def with_layer(self, region: str, layers: Mapping[str, float]) -> VolumeMesh:
        """This mesh and layers of prisms upon a region of faces: `layers` from the body outwards, name to thickness in
        mm. Each is a region of elements; the faces of the outermost are the region of faces 'OUTERMOST_top'. See
        `stacked`. Throws InvalidInput."""
        return VolumeMesh(**upon(self, region, layers))

    def summary(self) -> str:
        """What was made and how good it is, in lines."""
        lines = [self._counts(), *([str(self.quality)] if len(self.tetrahedra) else [])]
        volumes = self.element_volumes
        for name, region in self.volume_regions.items():
            parts = [f"{len(cells)} {kind}" for kind, cells in self._parts(region).items() if len(cells)]
            lines.append(f"region {name}: {', '.join(parts)}, {volumes[region].sum():.6g} mm^3")
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
        write_msh(path, self)

    def to_meshio(self) -> meshio.Mesh:
        return neighbours.to_meshio(self)

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        return neighbours.to_pyvista(self)

    @staticmethod
    def from_meshio(mesh: meshio.Mesh) -> VolumeMesh:
        return VolumeMesh(**neighbours.from_meshio(mesh))

    @staticmethod
    def from_pyvista(grid: pyvista.UnstructuredGrid) -> VolumeMesh:
        return VolumeMesh(**neighbours.from_pyvista(grid))
