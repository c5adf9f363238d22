"""Results of softkin.measure for pictures and films."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from . import _core
from ._arrays import Floats
from ._files import PathLike, write
from ._of_robot import parsed
from .table import Table

if TYPE_CHECKING:
    import softkin._vision as _vision


@dataclass(frozen=True)
class MarkerPlace:
    """Where a marker is."""

    place_mm: Floats
    """(2,) x to the right, y up [mm]"""
    error_mm: float
    """standard error along an axis"""
    pixel: Floats
    """(2,) x to the right, y down, (0, 0) is the centre of the first pixel"""


@dataclass(frozen=True)
class Angle:
    """Of a line against x, or against another line; counter-clockwise."""

    degrees: float
    error_deg: float
    """standard error"""


@dataclass(frozen=True)
class Specimen:
    """A bar of two materials, A at its fixed end, with standard errors."""

    length_mm: float
    """L: from the fixed end of A to the free end of B"""
    length_error_mm: float
    interface_mm: float
    """L_1: from the fixed end to where A and B meet"""
    interface_error_mm: float
    interface_deg: float
    """slant of the interface against the normal of the axis, counter-clockwise"""
    interface_error_deg: float
    axis_deg: float
    """direction from A to B, counter-clockwise from x"""


@dataclass(frozen=True)
class Stretch:
    """The changes of a stretched specimen relative to the first picture, with standard errors."""

    elongation_mm: float
    """Delta L"""
    elongation_error_mm: float
    shift_mm: float
    """Delta L_1"""
    shift_error_mm: float
    elasticity_ratio: float | None
    """E_A / E_B by Eq. (16) of Fang et al. 2020; None: A is not stretched by more than the error"""
    elasticity_ratio_error: float | None


@dataclass(frozen=True)
class Outline:
    """The outer outline of the largest part of a colour or brightness."""

    points_mm: Floats
    """(n, 2) one after another along it, without those at the picture's border"""
    length_mm: float
    area_mm2: float
    """that it encloses"""
    cut: bool
    """does it reach the picture's border?"""


@dataclass(frozen=True)
class Picture:
    """The markers, angles, specimen and outline that were found in a picture."""

    name: str
    markers: dict[str, MarkerPlace]
    angles: dict[str, Angle]
    """by 'angle_a_b', 'angle_a_b_c_d'"""
    specimen: Specimen | None
    outline: Outline | None = None


class _Measured:
    """The base class of the results for pictures and films."""

    _core: _vision.PhotoSeries | _vision.FilmTrack

    def _json(self) -> str:
        return self._core.json()

    @cached_property
    def report(self) -> dict[str, Any]:
        """What `softkin measure --json` prints."""
        return parsed(self._json())

    @property
    def notes(self) -> list[str]:
        """How scale, lens and axes were found."""
        return list(self.report["notes"])

    @property
    def mm_per_pixel(self) -> float:
        """In the middle of the first picture."""
        return float(self.report["mm_per_pixel"])

    @property
    def table(self) -> Table:
        """The columns of the file, not rounded."""
        keys, rows = self._core.table()
        return Table(_core.Table.of_numbers(keys, rows))

    def csv(self) -> str:
        """What `softkin measure -o` writes."""
        return self._core.csv()

    def save(self, path: PathLike) -> None:
        """The table: a .csv, which softkin.calibrate and softkin.compare read."""
        write(path, self.csv())


class Pictures(_Measured, Sequence[Picture]):
    """Photographs; the first one is the rest of specimens and angles."""

    _core: _vision.PhotoSeries

    def __init__(self, core: _vision.PhotoSeries) -> None:
        self._core = core

    @cached_property
    def _pictures(self) -> list[Picture]:
        return [_picture(entry) for entry in self.report["pictures"]]

    def __len__(self) -> int:
        return len(self._pictures)

    @overload
    def __getitem__(self, place: int) -> Picture: ...

    @overload
    def __getitem__(self, place: slice) -> Sequence[Picture]: ...

    def __getitem__(self, place: int | slice) -> Picture | Sequence[Picture]:
        return self._pictures[place]

    def __iter__(self) -> Iterator[Picture]:
        return iter(self._pictures)

    @property
    def stretches(self) -> list[Stretch]:
        """Of a specimen: the pictures after the first against it."""
        keys = ("dl_mm", "dL_error_mm", "dl1_mm", "dL1_error_mm", "E_A_by_E_B", "E_A_by_E_B_error")
        return [Stretch(*(entry[key] for key in keys)) for entry in self.report.get("stretches", ())]

    def __repr__(self) -> str:
        return repr(self.table)

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


def _picture(entry: Mapping[str, Any]) -> Picture:
    markers = {
        name: MarkerPlace(np.array([at["x_mm"], at["y_mm"]]), at["error_mm"], np.array([at["x_px"], at["y_px"]]))
        for name, at in entry.get("markers", {}).items()
    }
    angles = {name: Angle(at["degrees"], at["error_deg"]) for name, at in entry.get("angles", {}).items()}
    keys = ("l_mm", "L_error_mm", "l1_mm", "L1_error_mm", "interface_deg", "interface_error_deg", "axis_deg")
    seen = entry.get("specimen")
    specimen = None if seen is None else Specimen(*(seen[key] for key in keys))
    around = entry.get("outline")
    outline = None
    if around is not None:
        points = np.array([around["x_mm"], around["y_mm"]]).T
        outline = Outline(points, around["length_mm"], around["area_mm2"], around["cut"])
    return Picture(entry["picture"], markers, angles, specimen, outline)


class Track(_Measured):
    """The trajectories of a film's markers: one row for each frame that shows all of them."""

    _core: _vision.FilmTrack

    def __init__(self, core: _vision.FilmTrack) -> None:
        self._core = core

    @property
    def markers(self) -> list[str]:
        return self._core.markers()

    @cached_property
    def _numbers(self) -> Floats:
        return np.array(self._core.table()[1])

    @property
    def times(self) -> Floats:
        """(f,) since the first frame [s]."""
        return self._numbers[:, 0].copy()

    @property
    def places(self) -> Floats:
        """(f, p, 2) of the markers [mm]."""
        count = len(self.markers)
        return self._numbers[:, 1 : 1 + 2 * count].reshape(-1, count, 2).copy()

    def __getitem__(self, marker: str) -> Floats:
        """(f, 2) places of a marker [mm]."""
        return self.places[:, self.markers.index(marker)].copy()

    def __len__(self) -> int:
        """Frames that were measured."""
        return len(self._numbers)

    @property
    def frames(self) -> int:
        """Of the film."""
        return int(self.report["frames"])

    @property
    def frames_per_second(self) -> float:
        return float(self.report["frames_per_second"])

    @property
    def left_out(self) -> list[str]:
        """For each omitted frame, the reason; the command's exit code is 1 where a frame was omitted."""
        return list(self.report["left_out"])

    def __repr__(self) -> str:
        return f"<softkin.measure.Track of {', '.join(self.markers)}: {len(self)} of {self.frames} frames>"

    def _repr_html_(self) -> str:
        return self.table._repr_html_()
