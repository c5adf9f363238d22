"""Faces of a boundary, chosen by where they are."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from .arrays import Array
from .distance import distances
from .errors import InvalidInput
from .surface import as_surface

FORMS = (
    "'plane z=0', 'plane 0 0 1 = 0' (normal and its product with a point), 'box x y z x y z' (low and high corner), "
    "'sphere x y z radius', or a map with plane, box, sphere or near (a surface in mm), and within (mm)"
)
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


def choose_faces(name: str, chosen_by: Any, vertices: Array, faces: Array, tolerance: float) -> Array:
    """Returns the faces (k, 3) whose corners all lie within `within` of `chosen_by`, default 1.5 times the tolerance.

    chosen_by: 'plane z=0', 'plane 0 0 1 = 0', 'box 0 0 0 1 1 1', 'sphere x y z radius', each in mm; or a map with the
    key plane ('z=0'), box ([[x, y, z], [x, y, z]]), sphere ({'center': [x, y, z], 'radius': r}) or near (a surface
    in mm), and 'within' (mm). A plane selects only faces along it. Throws InvalidInput, which names the
    nearest face.
    """
    key, value, within = _parse(name, chosen_by)
    within = 1.5 * tolerance if within is None else within
    gap, normal = _MEASURES[key](name, value)
    used, which = np.unique(faces, return_inverse=True)
    corner_gaps = gap(vertices[used])[which.reshape(-1, 3)]
    chosen = (corner_gaps <= within).all(axis=1)
    if normal is not None:  # a thin rim of slanted faces may be within too
        corners = vertices[faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        chosen &= np.abs(across @ normal) > 0.5 * np.linalg.norm(across, axis=1)
    if not chosen.any():
        nearest = int(np.argmin(corner_gaps.max(axis=1)))
        middle = ", ".join(f"{value:.4g}" for value in vertices[faces[nearest]].mean(axis=0))
        low, high = (
            ", ".join(f"{value:.4g}" for value in corner)
            for corner in (vertices[used].min(axis=0), vertices[used].max(axis=0))
        )
        raise InvalidInput(
            f"region {name}: no face of the boundary lies within {within:.3g} mm of {chosen_by!r}; the nearest, at"
            f" ({middle}) mm, is {corner_gaps.max(axis=1)[nearest]:.4g} mm away. The body reaches from ({low}) to"
            f" ({high}) mm"
        )
    return faces[chosen]


def _parse(name: str, chosen_by: Any) -> tuple[str, Any, Any]:
    if isinstance(chosen_by, str):
        key, _, rest = chosen_by.strip().partition(" ")
        rest, _, distance = rest.partition(" within ")
        if key in ("plane", "box", "sphere"):
            return key, rest.strip(), _length(name, distance) if distance else None
    elif isinstance(chosen_by, Mapping):
        keys = [key for key in chosen_by if key in _MEASURES]
        if len(keys) == 1 and set(chosen_by) <= {keys[0], "within"}:
            within = chosen_by.get("within")
            return keys[0], chosen_by[keys[0]], None if within is None else _length(name, within)
    raise InvalidInput(f"region {name}: {chosen_by!r} chooses no faces; give {FORMS}")


def _length(name: str, value: Any) -> float:
    try:
        length = float(value)
    except (TypeError, ValueError):
        length = -1
    if not (np.isfinite(length) and length >= 0):
        raise InvalidInput(f"region {name}: within {value!r}: give a length in mm, >= 0")
    return length


Measure = tuple[Callable[[Array], Array], Any]


def _plane(name: str, value: Any) -> Measure:
    text = str(value)
    axis = re.fullmatch(rf"\s*([xyz])\s*=\s*({NUMBER})\s*", text)
    if axis:
        normal, offset = np.eye(3)["xyz".index(axis[1])], float(axis[2])
    else:
        left, _, right = text.partition("=")
        normal, offset = _numbers(name, left, 3), float(_numbers(name, right, 1)[0])
        length = float(np.linalg.norm(normal))
        if length == 0:
            raise InvalidInput(f"region {name}: the normal of the plane '{text}' has no length")
        normal, offset = normal / length, offset / length
    return lambda points: np.abs(points @ normal - offset), normal


def _box(name: str, value: Any) -> Measure:
    numbers = _numbers(name, value, 6)
    low, high = numbers[:3], numbers[3:]
    if (low > high).any():
        raise InvalidInput(f"region {name}: box from {low.tolist()} to {high.tolist()}: the low corner comes first")
    return lambda points: np.linalg.norm(np.maximum(np.maximum(low - points, points - high), 0), axis=1), None


def _sphere(name: str, value: Any) -> Measure:
    if isinstance(value, Mapping):
        value = [*value.get("center", ()), value.get("radius", "")]
    numbers = _numbers(name, value, 4)
    return lambda points: np.maximum(np.linalg.norm(points - numbers[:3], axis=1) - numbers[3], 0), None


def _near(name: str, value: Any) -> Measure:
    surface = as_surface(value, name)
    return lambda points: distances(surface.corners, points), None


_MEASURES: dict[str, Callable[[str, Any], Measure]] = {"plane": _plane, "box": _box, "sphere": _sphere, "near": _near}


def _numbers(name: str, value: Any, count: int) -> Array:
    try:
        parts = value.replace(",", " ").split() if isinstance(value, str) else np.ravel(value).tolist()
        numbers = np.array([float(part) for part in parts])
    except (TypeError, ValueError):
        numbers = np.array([])
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise InvalidInput(f"region {name}: {value!r} are not {count} number{'s' if count > 1 else ''}; give {FORMS}")
    return numbers
