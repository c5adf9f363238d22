"""From surfaces to a volume mesh with named regions."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import gmsh_program, tetwild
from .arrays import Array
from .child import ProgressFunction
from .deviation import deviation
from .elements import boundary_faces, check_name, compacted, face_pairs, positive, renumbering, signed_volumes
from .errors import InvalidInput, MeshWarning
from .estimate import check_size, counted
from .face_regions import choose_faces
from .labels import Labels, check_clear, label, place
from .repair import repaired
from .snap import snapped
from .surface import MM_PER_UNIT, Surface, SurfaceLike, as_surface
from .volume_mesh import Volume, VolumeMesh

METRES_BELOW = 2.0  # mm, diagonal of a body: no robot, but a robot in metres


@dataclass(frozen=True)
class Given:
    """Surfaces in mm by region name: the body, its chambers, its parts."""

    body: Surface
    chambers: dict[str, Surface]
    parts: dict[str, Surface]

    @property
    def all(self) -> dict[str, Surface]:
        return {"body": self.body, **self.chambers, **self.parts}


def from_surfaces(
    body: SurfaceLike,
    chambers: Mapping[str, SurfaceLike] | None = None,
    parts: Mapping[str, SurfaceLike] | None = None,
    *,
    edge_length: float,
    unit: str = "mm",
    regions: Mapping[str, Any] | None = None,
    tolerance: float | None = None,
    backend: str = "tetwild",
    chambers_as: str = "region",
    open_chambers: bool = False,
    coarsen: bool = False,
    progress: ProgressFunction | None = None,
) -> VolumeMesh:
    """A volume mesh of a body with chambers and parts, each given by its surface.

    body, chambers, parts: surfaces by region name: files (.stl, .obj, .ply, .off; with backend 'gmsh' .step too),
        `Surface`s, pairs (vertices, triangles), PyVista or meshio meshes. They may have holes (which are closed),
        flipped faces and self-intersections. Chambers lie within the body, as shells of the body's own surface or not.
        Parts that stick out of the body add to it. Where they overlap, chambers count before parts, and the smaller
        before the larger.
    edge_length: of the tetrahedra where nothing asks for smaller ones, mm.
    unit: of the coordinates of the surfaces: mm, cm, m, um or in. All other lengths are in mm.
    regions: face regions of the boundary by name, see `choose_faces`: 'plane z=0', {'box': [[..], [..]]}, ...
    tolerance: how far the mesh may be from a surface, mm; default: a 20th of edge_length, or a 1000th of the diagonal
        of the body where that is less. Walls thinner than twice the tolerance may get lost.
    backend: 'tetwild' (fTetWild) or 'gmsh' (the program, for clean surfaces).
    chambers_as: 'region': the chambers are meshed and are volume regions, NAME, with their walls as face regions
        NAME_wall. 'void': they are left empty, with their walls as face regions NAME.
    open_chambers: whether a chamber may reach the outside, where a plate or a plane of symmetry closes it.
    coarsen: tetwild: as few tetrahedra as their shapes allow, of any length.
    progress: called with what is being done and for how long it has been [s], about ten times a second; what it raises,
        and Ctrl-C, ends the work.
    Returns a `VolumeMesh`. Throws InvalidInput, ImportError (pytetwild), and warns with MeshWarning.
    """
    _check_choices(unit, backend, chambers_as, edge_length, tolerance)
    given = _read(body, chambers or {}, parts or {}, unit, backend)
    _check_sizes(given, edge_length, unit)
    if tolerance is None:
        tolerance = min(edge_length / 20, given.body.diagonal / 1000)
    given = Given(repaired(given.body), _each(repaired, given.chambers), _each(repaired, given.parts))
    for name, surface in given.all.items():
        check_clear(name, surface)
    surfaces = list(given.all.values())
    expected = check_size(surfaces, edge_length, backend, coarsen)
    what = f"meshing, about {counted(expected)} tetrahedra"
    if backend == "gmsh":
        points, tetrahedra = gmsh_program.background(surfaces, edge_length, what, progress)
    else:
        points, tetrahedra = tetwild.background(surfaces, edge_length, tolerance, coarsen, what, progress)
    tetrahedra = positive(points, tetrahedra)
    labels = label(points, tetrahedra, given.body, given.chambers, given.parts, tolerance)
    if backend == "tetwild":  # gmsh puts its vertices there
        points = snapped(points, tetrahedra, labels, given.all, tolerance)
    _check_apart(points, tetrahedra, labels, given)
    if not open_chambers:
        _check_closed(points, tetrahedra, labels, given)
    deviations = {
        name: deviation(surface, points, boundary_faces(tetrahedra[labels.inside[name]]), tolerance)
        for name, surface in given.all.items()
    }
    mesh = _assemble(points, tetrahedra, labels, given, chambers_as, regions or {}, deviations, tolerance)
    _warn(mesh)
    return mesh


def _check_choices(unit: str, backend: str, chambers_as: str, edge_length: float, tolerance: float | None) -> None:
    for name, value, choices in (
        ("unit", unit, tuple(MM_PER_UNIT)),
        ("backend", backend, ("tetwild", "gmsh")),
        ("chambers_as", chambers_as, ("region", "void")),
    ):
        if value not in choices:
            raise InvalidInput(f"{name}={value!r}: it is one of {', '.join(choices)}")
    for name, length in (("edge_length", edge_length), ("tolerance", tolerance)):
        if length is not None and not (math.isfinite(length) and length > 0):
            raise InvalidInput(f"{name}={length!r}: give a length in mm, > 0")


def _read(
    body: SurfaceLike, chambers: Mapping[str, SurfaceLike], parts: Mapping[str, SurfaceLike], unit: str, backend: str
) -> Given:
    names = ["body", *chambers, *parts]
    for name in names:
        if names.count(name) > 1:
            raise InvalidInput(
                f"'{name}' names two surfaces; give every chamber and part a name of its own, other than 'body'"
            )
        check_name(name)
    read = gmsh_program.read_surface if backend == "gmsh" else as_surface

    def one(name: str, given: SurfaceLike) -> Surface:
        return read(given, name).scaled(MM_PER_UNIT[unit])

    return Given(
        one("body", body), {n: one(n, g) for n, g in chambers.items()}, {n: one(n, g) for n, g in parts.items()}
    )


def _each(change: Any, surfaces: dict[str, Surface]) -> dict[str, Surface]:
    return {name: change(surface) for name, surface in surfaces.items()}


def _check_sizes(given: Given, edge_length: float, unit: str) -> None:
    diagonal = given.body.diagonal
    size = " x ".join(f"{length:.3g}" for length in given.body.size)
    if diagonal < METRES_BELOW and unit == "mm":
        warnings.warn(
            f"{given.body.name} measures {size} mm: are these metres? Then say unit='m'", MeshWarning, stacklevel=3
        )
    if edge_length > diagonal:
        raise InvalidInput(
            f"edge_length={edge_length:g} mm is longer than the body, which measures {size} mm; is its unit {unit}?"
        )
    for name, surface in {**given.chambers, **given.parts}.items():
        if surface.diagonal > 20 * diagonal:
            raise InvalidInput(
                f"{name}: {surface.name} is {surface.diagonal / diagonal:.0f} times as large as the body; are both in"
                f" {unit}?"
            )


def _check_apart(points: Array, tetrahedra: Array, labels: Labels, given: Given) -> None:
    faces, first, second = face_pairs(tetrahedra)
    chamber = np.zeros(len(tetrahedra) + 1, dtype=np.int64)
    for number, name in enumerate(given.chambers, 1):
        chamber[:-1][labels.regions[name]] = number
    touching = (chamber[first] != chamber[second]) & (chamber[first] > 0) & (chamber[second] > 0)
    if touching.any():
        one, two = (list(given.chambers)[chamber[side[touching][0]] - 1] for side in (first, second))
        raise InvalidInput(
            f"chambers {one} and {two} touch at {place(points[faces[touching][0]].mean(axis=0))}: there is no wall"
            " between them, or a thinner one than the tolerance"
        )


def _check_closed(points: Array, tetrahedra: Array, labels: Labels, given: Given) -> None:
    faces, first, second = face_pairs(tetrahedra)
    kept = np.append(labels.kept, False)  # -1: outside of the box
    for name in given.chambers:
        own = np.append(labels.regions[name], False)
        touching = (own[first] & ~kept[second]) | (own[second] & ~kept[first])
        if touching.any():
            corners = points[faces[touching]]
            area = (
                np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum() / 2
            )
            raise InvalidInput(
                f"chamber {name} touches the outside of the body at {place(corners.mean(axis=(0, 1)))}, over {area:.3g}"
                " mm^2: its wall there has no thickness, or less than the tolerance. Move its surface inwards, or say"
                " open_chambers=True where a plate closes it"
            )


def _assemble(
    points: Array,
    tetrahedra: Array,
    labels: Labels,
    given: Given,
    chambers_as: str,
    regions: Mapping[str, Any],
    deviations: dict[str, float],
    tolerance: float,
) -> VolumeMesh:
    chambers = np.zeros(len(tetrahedra), dtype=bool)
    for name in given.chambers:
        chambers |= labels.regions[name]
    solid = labels.kept & ~chambers
    walls = _walls(tetrahedra, solid, labels, given.chambers)
    left_out = set() if chambers_as == "region" else set(given.chambers)
    blocks = {
        name: np.flatnonzero(flags) for name, flags in labels.regions.items() if flags.any() and name not in left_out
    }
    chosen = np.concatenate(list(blocks.values()))  # region by region, as files of Gmsh have them
    new_number = renumbering(len(points), tetrahedra[chosen])
    vertices, cells = compacted(points, tetrahedra[chosen])
    ends = np.cumsum([len(block) for block in blocks.values()])
    volumes = {name: np.arange(end - len(block), end) for (name, block), end in zip(blocks.items(), ends)}
    suffix = "_wall" if chambers_as == "region" else ""
    faces = {f"{name}{suffix}": new_number[wall] for name, wall in walls.items()}
    outer = new_number[_outer_faces(tetrahedra, labels.kept, labels.kept if chambers_as == "region" else solid)]
    for name, chosen_by in regions.items():
        check_name(name)
        if name in volumes or name in faces or name in given.chambers:
            raise InvalidInput(f"regions: '{name}' is a region already: give the faces another name")
        faces[name] = choose_faces(name, chosen_by, vertices, outer, tolerance)
    notes = tuple(note for surface in given.all.values() for note in surface.notes) + labels.notes
    all_volumes = signed_volumes(points, tetrahedra)
    sizes = {n: Volume(float(all_volumes[labels.inside[n]].sum()), s.volume) for n, s in given.all.items()}
    return VolumeMesh(vertices, cells, volumes, faces, sizes, deviations, tolerance, notes)


def _outer_faces(tetrahedra: Array, kept: Array, meshed: Array) -> Array:
    """Faces of the boundary of what is kept that tetrahedra of the mesh have."""
    faces, first, second = face_pairs(tetrahedra[kept])
    return faces[(second < 0) & meshed[kept][first]]


def _walls(tetrahedra: Array, solid: Array, labels: Labels, chambers: Mapping[str, Surface]) -> dict[str, Array]:
    """Faces between each chamber and the solid, normals out of the chamber."""
    walls = {}
    for name in chambers:
        own = labels.regions[name]
        faces, first, second = face_pairs(tetrahedra[own | solid])
        own_there = np.append(own[own | solid], False)
        of_first = own_there[first] & ~own_there[second] & (second >= 0)
        of_second = own_there[second] & ~own_there[first]
        walls[name] = np.concatenate([faces[of_first], faces[of_second][:, [0, 2, 1]]])
    return walls


def _warn(mesh: VolumeMesh) -> None:
    for name, distance in mesh.deviation_mm.items():
        if distance > 1.5 * mesh.tolerance_mm:
            text = (
                f"surface {name}: the mesh is {distance:.3g} mm from it, tolerance {mesh.tolerance_mm:.3g} mm: take a"
                " shorter edge_length or tolerance"
            )
            warnings.warn(text, MeshWarning, stacklevel=3)
    quality = mesh.quality
    if quality.inverted:
        raise InvalidInput(f"{quality.inverted} tetrahedra have no volume; take another tolerance or edge_length")
    if quality.parts > 1:
        warnings.warn(f"the mesh is in {quality.parts} parts without common faces", MeshWarning, stacklevel=3)
