"""A scene to start from."""

from __future__ import annotations

import json
import re

import numpy as np

from .arrays import Array
from .errors import InvalidInput
from .volume_mesh import VolumeMesh

NEAR_END = 0.02  # of the length: what counts as an end


def scene_text(mesh: VolumeMesh, mesh_file: str, chambers: list[str], fixed: str = "") -> str:
    """A scene for a mesh of `from_surfaces`, with comments on what to edit.

    mesh_file: the mesh, as seen from the scene. chambers: regions of elements or, of chambers that are left empty, of
    their walls. fixed: the region that is held; default: base, or else the low end along the longest side.
    Throws InvalidInput on unknown regions.
    """
    for name in [*chambers, *([fixed] if fixed else [])]:
        if name not in mesh.regions:
            raise InvalidInput(f"no region '{name}'; there are: {', '.join(mesh.regions)}")
    solids = [name for name in mesh.volume_regions if name not in chambers]
    held, tip = _ends(mesh, solids, fixed or ("base" if "base" in mesh.regions else ""))
    lines = [
        "softkin: 1",
        "units: {length: mm}",
        f"mesh: {{file: {_quoted(mesh_file)}, order: 2}}   # order 1 is faster, but thin walls then are too stiff",
        "formulation: physical",
        "materials:   # edit: Young's modulus in MPa, density in kg/m^3; 1 MPa is a silicone of Shore 30A or so",
    ]
    lines += [
        f"  - {{region: {_quoted(name)}, youngs_modulus: {1 if name == 'body' else 100}, poisson_ratio: 0.45, density:"
        " 1100}"
        for name in solids
    ]
    lines += ["# gravity: [0, 0, -9.81]   # m/s^2", "fixed:   # edit: where the robot is held", f"  - {held}"]
    if chambers:
        lines.append(
            "actuators:   # edit: range is the volume over that at rest; with control: pressure it is in kPa, such as"
            " [0, 50]"
        )
    for name in chambers:
        where = f"region: {_quoted(name)}" if name in mesh.volume_regions else f"surface: {{region: {_quoted(name)}}}"
        lines.append(f"  - {{name: {_quoted(name)}, kind: pneumatic, {where}, control: volume, range: [1.0, 1.5]}}")
    if not chambers:
        lines.append(
            "# actuators:   # nothing drives this robot yet; such as a cable along points inside it, range: length over"
            " that at rest"
        )
        lines.append("#   - {name: tendon, kind: cable, points: [[0, 0, 0], [10, 0, 0]], range: [0.8, 1.0]}")
    lines += [
        "markers:   # edit: points to watch and to steer",
        f"  - {{name: tip, point: {_list(tip)}}}   # the far end",
        "",
    ]
    return "\n".join(lines)


def _ends(mesh: VolumeMesh, solids: list[str], fixed: str) -> tuple[str, Array]:
    """The entry of `fixed`, and a vertex of the body in the middle of the other end."""
    chosen = np.concatenate([mesh.volume_regions[name] for name in solids]) if solids else None
    points = mesh.vertices[_corners(mesh, chosen)]
    low, high = points.min(axis=0), points.max(axis=0)
    axis = int(np.argmax(high - low))
    upwards = True
    held = f"{{region: {_quoted(fixed)}}}"
    if fixed:
        faces = mesh.face_regions.get(fixed)
        vertices = _corners(mesh, mesh.volume_regions[fixed]) if faces is None else np.unique(faces)
        middle = mesh.vertices[vertices].mean(axis=0)
        axis = int(np.argmax(np.maximum(high - middle, middle - low)))
        upwards = bool(high[axis] - middle[axis] >= middle[axis] - low[axis])
    else:
        plane = low.copy()
        plane[axis] += NEAR_END * (high - low)[axis]
        held = f"{{halfspace: {{point: {_list(plane)}, normal: {[-int(k == axis) for k in range(3)]}}}}}"
    depth = (high - points)[:, axis] if upwards else (points - low)[:, axis]
    end = points[depth <= NEAR_END * (high - low)[axis]]
    middle = (end.min(axis=0) + end.max(axis=0)) / 2
    return held, end[int(np.argmin(((end - middle) ** 2).sum(axis=1)))]


def _corners(mesh: VolumeMesh, elements: Array | None) -> Array:
    """Vertices of elements, of all where None."""
    first = len(mesh.tetrahedra)
    chosen = np.arange(first + len(mesh.prisms)) if elements is None else elements
    tetrahedra, prisms = mesh.tetrahedra[chosen[chosen < first]], mesh.prisms[chosen[chosen >= first] - first]
    return np.unique(np.concatenate([tetrahedra.ravel(), prisms.ravel()]))


def _list(values: Array) -> str:
    return "[" + ", ".join(f"{value:.6g}" for value in values) + "]"


def _quoted(text: str) -> str:
    plain = re.fullmatch(r"[A-Za-z_./][\w./-]*", text) and text.lower() not in (
        "true",
        "false",
        "yes",
        "no",
        "on",
        "off",
        "null",
        "y",
        "n",
    )
    return text if plain else json.dumps(text, ensure_ascii=False)
