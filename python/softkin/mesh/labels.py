"""Which tetrahedra are inside which surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .arrays import Array, Flags
from .elements import face_pairs, signed_volumes
from .errors import InvalidInput
from .repair import components, open_edges, shell_volumes
from .surface import Surface
from .winding import winding_numbers

UNCLEAR = 0.1  # of the volume with winding numbers above 1/4: more of it below 3/4, and the surface has no inside
PROBES = 2000
FLAT = 1e-9  # of area times diagonal: less volume is none
CRUMB = 1e-3  # of the volume: smaller loose pieces are left out


@dataclass(frozen=True)
class Labels:
    """Flags of all tetrahedra, (m,) each. inside: by surface. regions: by region, exclusive. kept: in any region."""

    inside: dict[str, Flags]
    regions: dict[str, Flags]
    kept: Flags
    notes: tuple[str, ...]


def label(
    points: Array,
    tetrahedra: Array,
    body: Surface,
    chambers: dict[str, Surface],
    parts: dict[str, Surface],
    tolerance: float,
) -> Labels:
    """Labels tetrahedra by the winding numbers around their middles. Throws InvalidInput."""
    middles = points[tetrahedra].mean(axis=1)
    volumes = signed_volumes(points, tetrahedra)
    inside = {name: _inside(name, s, middles, volumes) for name, s in {"body": body, **chambers, **parts}.items()}
    hull = inside["body"] | _inside_hull(body, middles)
    notes: list[str] = []
    for name, surface in chambers.items():
        _check_within(name, surface, inside[name] & ~hull, inside[name], middles, volumes, tolerance)
        inside[name] &= hull
    for name in parts:
        outside = float(volumes[inside[name] & ~hull].sum())
        if outside > tolerance * parts[name].area:
            notes.append(f"part {name}: {outside:.4g} mm^3 of it stick out of the body and add to it")
    left = np.ones(len(tetrahedra), dtype=bool)
    regions: dict[str, Array] = {}
    for group in (chambers, parts):
        for name in sorted(group, key=lambda each: float(volumes[inside[each]].sum())):
            regions[name] = inside[name] & left
            left &= ~regions[name]
    regions["body"] = inside["body"] & left
    kept = np.any(list(regions.values()), axis=0)
    kept, crumbs = _without_crumbs(tetrahedra, kept, volumes)
    if crumbs:
        notes.append(f"{crumbs} tetrahedra in loose crumbs are left out")
    ordered = {name: regions[name] & kept for name in ("body", *chambers, *parts)}
    for name, flags in ordered.items():
        if not flags.any() and not (name == "body" and parts):
            raise InvalidInput(
                f"{name}: no tetrahedra are left for it; other surfaces take all of its inside, or it is thinner than"
                " the tolerance"
            )
    inside_kept = {name: flags & kept for name, flags in inside.items()}
    return Labels(
        inside_kept,
        ordered,
        kept,
        tuple(notes),
    )


def check_clear(name: str, surface: Surface) -> None:
    """Throws InvalidInput where a surface has no clear inside, before hours are spent on it."""
    if abs(surface.volume) <= FLAT * surface.area * surface.diagonal:
        raise InvalidInput(f"{name}: {surface.name} encloses nothing; {_state(surface)}")
    corners = surface.corners.reshape(-1, 3)
    low, size = corners.min(axis=0), np.ptp(corners, axis=0)
    winding = winding_numbers(surface, low + np.random.default_rng(0).random((PROBES, 3)) * size)
    _judge(name, surface, winding, np.ones(PROBES))


def place(point: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in point) + ") mm"


def _inside(name: str, surface: Surface, middles: Array, volumes: Array) -> Array:
    winding = _winding(surface, middles)
    if not (winding > 0.5).any():
        raise InvalidInput(f"{name}: {surface.name} encloses nothing; {_state(surface)}")
    _judge(name, surface, winding, volumes)
    return winding > 0.5


def _judge(name: str, surface: Surface, winding: Array, weights: Array) -> None:
    all_of_it = float(weights[winding > 0.25].sum())
    doubtful = float(weights[np.abs(winding - 0.5) < 0.25].sum())
    if doubtful > UNCLEAR * all_of_it:
        raise InvalidInput(
            f"{name}: {surface.name} has no clear inside ({100 * doubtful / all_of_it:.0f} % of it are doubtful);"
            f" {_state(surface)}"
        )


def _state(surface: Surface) -> str:
    count = len(open_edges(surface))
    return f"it has {count} open edges after its holes were closed" if count else "its faces cross or face each other"


def _inside_hull(body: Surface, middles: Array) -> Array:
    """Inside of the shells of the body that do not turn inwards: with its cavities."""
    shell, volumes = shell_volumes(body)
    outward = volumes[shell] > 0
    if outward.all():
        return np.zeros(len(middles), dtype=bool)  # the body itself
    return _winding(body.with_triangles(body.triangles[outward]), middles) > 0.5


def _winding(surface: Surface, middles: Array) -> Array:
    corners = surface.corners.reshape(-1, 3)
    near = ((middles >= corners.min(axis=0)) & (middles <= corners.max(axis=0))).all(axis=1)
    winding = np.zeros(len(middles))
    winding[near] = winding_numbers(surface, middles[near])
    return winding


def _check_within(
    name: str, surface: Surface, out: Array, inside: Array, middles: Array, volumes: Array, tolerance: float
) -> None:
    beyond, all_of_it = float(volumes[out].sum()), float(volumes[inside].sum())
    if beyond > 0.99 * all_of_it:
        raise InvalidInput(
            f"chamber {name} ({surface.name}) lies outside of the body, around"
            f" {place(np.average(middles[inside], axis=0, weights=volumes[inside]))}; are both in one unit and place?"
        )
    if beyond > max(0.5 * tolerance * surface.area * beyond / all_of_it, 1e-3 * all_of_it):
        raise InvalidInput(
            f"chamber {name} ({surface.name}) sticks out of the body by {beyond:.3g} mm^3, around"
            f" {place(np.average(middles[out], axis=0, weights=volumes[out]))}"
        )


def _without_crumbs(tetrahedra: Array, kept: Array, volumes: Array) -> tuple[Array, int]:
    numbers = np.flatnonzero(kept)
    if len(numbers) == 0:
        return kept, 0
    _, first, second = face_pairs(tetrahedra[numbers])
    alone = np.arange(len(numbers))
    pairs = np.concatenate([np.stack([alone, alone], axis=1), np.stack([first, second], axis=1)[second >= 0]])
    part = components(pairs, len(numbers))[: len(numbers)]
    sizes = np.bincount(part, weights=volumes[numbers])
    crumbs = sizes[part] < CRUMB * sizes.sum()
    kept = kept.copy()
    kept[numbers[crumbs]] = False
    return kept, int(crumbs.sum())
