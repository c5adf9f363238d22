"""Markers, specimens, angles and tracks in mm, out of pictures and films: docs/measure.md.

Needs a softkin that was built where OpenCV is; `available()` tells.
"""

from __future__ import annotations

import importlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import Floats, floats
from .table import Table

if TYPE_CHECKING:
    import softkin._vision as _vision

__all__ = [
    "Angle",
    "Board",
    "Camera",
    "MarkerPlace",
    "Picture",
    "Pictures",
    "Specimen",
    "Stretch",
    "Track",
    "available",
    "camera",
    "film",
    "pictures",
    "read_camera",
]

PathLike = str | os.PathLike[str]
Image = NDArray[np.uint8]
ProgressFunction = Callable[[float], object]
Point = str | tuple[float, float]

INSTALL = (
    "softkin.measure needs a softkin built with OpenCV 4.5 or 4.6, which this one is not: "
    "apt-get install libopencv-dev, then pip install . from a clone of softkin"
)


def available() -> bool:
    """Was OpenCV there when this softkin was built, and does it load?"""
    try:
        _loaded()
    except ImportError:
        return False
    return True


def _loaded() -> Any:
    """The part on OpenCV, which takes a third of a second to load: not before it is needed."""
    try:
        return importlib.import_module("softkin._vision")
    except ImportError as error:
        raise ImportError(f"{INSTALL} ({error})") from None


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
    """What stretching did to a specimen, against the first picture, with standard errors."""

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
class Picture:
    """What a picture shows."""

    name: str
    markers: dict[str, MarkerPlace]
    angles: dict[str, Angle]
    """by 'angle_a_b', 'angle_a_b_c_d'"""
    specimen: Specimen | None


class _Measured:
    """What pictures and films have in common."""

    _core: _vision.PhotoSeries | _vision.FilmTrack

    def _json(self) -> str:
        return self._core.json()

    @cached_property
    def report(self) -> dict[str, Any]:
        """What `softkin measure --json` prints."""
        report: dict[str, Any] = json.loads(self._json())
        return report

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
        Path(path).write_text(self.csv())


class Pictures(_Measured, Sequence[Picture]):
    """Photographs; the first one is the rest of specimens and angles."""

    _core: _vision.PhotoSeries

    def __init__(self, core: _vision.PhotoSeries) -> None:
        self._core = core

    @cached_property
    def _pictures(self) -> list[Picture]:
        return [_picture(told) for told in self.report["pictures"]]

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
        return [Stretch(*(told[key] for key in keys)) for told in self.report.get("stretches", ())]

    def __repr__(self) -> str:
        return repr(self.table)

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


def _picture(told: Mapping[str, Any]) -> Picture:
    markers = {
        name: MarkerPlace(np.array([at["x_mm"], at["y_mm"]]), at["error_mm"], np.array([at["x_px"], at["y_px"]]))
        for name, at in told.get("markers", {}).items()
    }
    angles = {name: Angle(at["degrees"], at["error_deg"]) for name, at in told.get("angles", {}).items()}
    keys = ("l_mm", "L_error_mm", "l1_mm", "L1_error_mm", "interface_deg", "interface_error_deg", "axis_deg")
    seen = told.get("specimen")
    return Picture(told["picture"], markers, angles, None if seen is None else Specimen(*(seen[key] for key in keys)))


class Track(_Measured):
    """The way of a film's markers: one row a frame that shows them all."""

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
        """Why each frame is that was left out; the command's exit code is 1 where there is one."""
        return list(self.report["left_out"])

    def __repr__(self) -> str:
        return f"<softkin.measure.Track of {', '.join(self.markers)}: {len(self)} of {self.frames} frames>"

    def _repr_html_(self) -> str:
        return self.table._repr_html_()


@dataclass(frozen=True)
class Camera:
    """A pinhole with the lens distortion of Brown and Conrady, as OpenCV has it."""

    width: int
    """of its pictures [pixel]"""
    height: int
    matrix: Floats
    """(3, 3) [pixel]"""
    distortion: Floats
    """(5,) k1, k2, p1, p2, k3 [-]"""
    focal_error_px: float
    """standard error of both focal lengths"""
    reprojection_error_px: float
    """root of the mean square"""
    picture_errors_px: Floats
    """(k,) the same of each picture; (0,) of a camera from a file"""
    pictures: int
    """that it was found from"""

    def save(self, path: PathLike) -> None:
        """For `camera=` and `softkin measure --camera`: a .yaml."""
        Path(path).write_text(self._core().text())

    def _core(self) -> _vision.Camera:
        core: _vision.Camera = _loaded().Camera()
        core.width, core.height, core.pictures = self.width, self.height, self.pictures
        matrix = floats("matrix", self.matrix, (3, 3))
        core.fx, core.fy, core.cx, core.cy = matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]
        core.k1, core.k2, core.p1, core.p2, core.k3 = floats("distortion", self.distortion, (5,)).tolist()
        core.focal_error, core.reprojection_error = self.focal_error_px, self.reprojection_error_px
        return core


def _camera(core: _vision.Camera, errors: Sequence[float]) -> Camera:
    return Camera(
        core.width,
        core.height,
        np.array([[core.fx, 0, core.cx], [0, core.fy, core.cy], [0, 0, 1]]),
        np.array([core.k1, core.k2, core.p1, core.p2, core.k3]),
        core.focal_error,
        core.reprojection_error,
        np.array(errors),
        core.pictures,
    )


class Board:
    """A board to print: a white margin, then dark squares."""

    def __init__(self, text: str) -> None:
        self.text = text
        """'5x4,tag=12mm,gap=3mm', 'charuco,7x5,square=10mm,tag=7mm' or 'checker,9x6,square=10mm'"""
        self._core: _vision.Board = _loaded().Board(text)

    @property
    def width_mm(self) -> float:
        """Without the margin."""
        return self._core.width()

    @property
    def height_mm(self) -> float:
        return self._core.height()

    def svg(self) -> str:
        """True to scale."""
        return self._core.svg()

    def picture(self, dpi: float = 300) -> Image:
        """(h, w, 3) red, green, blue."""
        _check_dpi(dpi)
        return self._core.picture(dpi)

    def save(self, path: PathLike, dpi: float = 300) -> None:
        """A .svg, or a .png of so many dots per inch."""
        _check_dpi(dpi)
        file = Path(path)
        if file.suffix.lower() == ".svg":
            file.write_text(self.svg())
        elif file.suffix.lower() == ".png":
            file.write_bytes(self._core.png(dpi))
        else:
            raise ValueError(f"path must end in .svg or .png, not {file.name!r}")

    def __repr__(self) -> str:
        return f"<softkin.measure.Board {self.text}: {self.width_mm:g} x {self.height_mm:g} mm>"


def _check_dpi(dpi: float) -> None:
    if not 10 <= dpi <= 4800:
        raise ValueError(f"dpi must be 10 to 4800 dots per inch, not {dpi}")


def _named(name: str, given: str | Sequence[object] | Mapping[str, object] | None) -> str:
    """As the command takes it: red,tip=blue."""
    if given is None or isinstance(given, str):
        return given or ""
    if isinstance(given, Mapping):
        return ",".join(f"{key}={value}" for key, value in given.items())
    if len(given) == 0:
        raise ValueError(f"{name} is empty")
    return ",".join(str(value) for value in given)


def _scale(given: str | tuple[Point, Point, float] | None) -> str:
    if given is None or isinstance(given, str):
        return given or ""
    if len(given) != 3:
        raise ValueError(f"scale must be two markers or two pixels and their distance [mm], not {given!r}")
    first, second, distance = given
    points = [
        point if isinstance(point, str) else ",".join(repr(value) for value in floats("scale", point, (2,)).tolist())
        for point in (first, second)
    ]
    return f"{','.join(points)}={float(distance)!r}mm"


def _options(
    dots: str | Sequence[str] | Mapping[str, str] | None,
    tags: bool | str | Sequence[int] | Mapping[str, int] | None,
    dictionary: str | None,
    angles: Sequence[str | Sequence[str]],
    scale_board: str | Board | None,
    scale: str | tuple[Point, Point, float] | None,
    camera: PathLike | Camera | None,
    origin: str | None,
    x_axis: str | tuple[str, str] | None,
) -> _vision.Options:
    if isinstance(angles, str):
        raise ValueError(f"angles must be a list such as [('a', 'b')], not {angles!r}")
    options: _vision.Options = _loaded().Options()
    options.dots = _named("dots", dots)
    options.tags = "true" if tags is True else "" if tags is False else _named("tags", tags)
    options.dictionary = dictionary or ""
    options.angles = [_named("angles", angle) for angle in angles]
    options.board = scale_board.text if isinstance(scale_board, Board) else scale_board or ""
    options.scale = _scale(scale)
    if isinstance(camera, Camera):
        options.camera, options.lens = "given", camera._core()
    elif camera is not None:
        options.camera = os.fspath(camera)
    options.origin = origin or ""
    options.x_axis = _named("x_axis", x_axis)
    return options


def _check_threads(threads: int) -> None:
    if not 0 <= threads <= 1024:
        raise ValueError(f"threads must be 0 (one a core) to 1024, not {threads}")


def _add(
    series: _vision.PhotoSeries | _vision.CameraSurvey,
    given: Sequence[PathLike | Image],
    progress: ProgressFunction | None,
) -> None:
    if isinstance(given, (str, os.PathLike)) or len(given) == 0:
        raise ValueError("pictures must be a list of one or more: files, or arrays (h, w, 3) of bytes")
    for number, picture in enumerate(given):
        if progress is not None:
            progress(number / len(given))
        if isinstance(picture, (str, os.PathLike)):
            series.add_file(os.fspath(picture))
            continue
        name = f"pictures[{number}]"
        array = np.asarray(picture)
        if array.dtype != np.uint8 or array.ndim != 3 or array.shape[2] != 3:
            raise ValueError(f"{name} must be (h, w, 3) of uint8: red, green, blue; not {array.shape} of {array.dtype}")
        series.add_array(np.ascontiguousarray(array), name)
    if progress is not None:
        progress(1.0)


def pictures(
    pictures: Sequence[PathLike | Image],
    *,
    dots: str | Sequence[str] | Mapping[str, str] | None = None,
    tags: bool | str | Sequence[int] | Mapping[str, int] | None = None,
    dictionary: str | None = None,
    interface: str | tuple[str, str] | None = None,
    angles: Sequence[str | Sequence[str]] = (),
    scale_board: str | Board | None = None,
    scale: str | tuple[Point, Point, float] | None = None,
    camera: PathLike | Camera | None = None,
    origin: str | None = None,
    x_axis: str | tuple[str, str] | None = None,
    threads: int = 0,
    progress: ProgressFunction | None = None,
) -> Pictures:
    """Markers, angles and specimens of photographs. One of scale_board and scale is needed.

    pictures     files (PNG, JPEG, TIFF, ...), or arrays (h, w, 3) of bytes: red, green, blue
    dots         round dots of a colour each: {"tip": "blue"}, ["red", "green"], or a text: "red,tip=blue"
    tags         centres of ArUco tags: True for all in the first picture, {"tip": 7}, or [3, 7]
    dictionary   of the tags: '4x4_50' to '7x7_1000', 'original'; None: that of the board, else '4x4_50'
    interface    colours of a bar of two materials, that at the fixed end first: ("red", "blue")
    angles       of lines between markers: ("a", "b") against x, ("a", "b", "c", "d") of c to d against a to b
    scale_board  a printed board in the plane of the markers: '5x4,tag=12mm,gap=3mm', 'charuco,7x5,square=10mm,tag=7mm'
    scale        two markers, or two pixels (x, y), and their distance [mm]: ("a", "b", 25)
    camera       lens distortion to take out: what camera() returns, or its file
    origin       marker that is the origin, where it is in the first picture
    x_axis       markers from which to which x goes, in the first picture
    threads      of OpenCV; 0: one a core
    progress     called with the share that is done
    raises       InvalidInput naming the picture: a marker not found, or found twice, ...
    """
    _check_threads(threads)
    options = _options(dots, tags, dictionary, angles, scale_board, scale, camera, origin, x_axis)
    options.interface = _named("interface", interface)
    _loaded().prepare(threads)
    series: _vision.PhotoSeries = _loaded().PhotoSeries(options)
    _add(series, pictures, progress)
    return Pictures(series)


def film(
    files: PathLike | Sequence[PathLike],
    *,
    fps: float | None = None,
    dots: str | Sequence[str] | Mapping[str, str] | None = None,
    tags: bool | str | Sequence[int] | Mapping[str, int] | None = None,
    dictionary: str | None = None,
    angles: Sequence[str | Sequence[str]] = (),
    scale_board: str | Board | None = None,
    scale: str | tuple[Point, Point, float] | None = None,
    camera: PathLike | Camera | None = None,
    origin: str | None = None,
    x_axis: str | tuple[str, str] | None = None,
    moving_camera: bool = False,
    threads: int = 0,
    progress: ProgressFunction | None = None,
) -> Track:
    """The track of a film's markers. The first frame must show all; a later one that does not is left out.

    files          a video, a folder of numbered pictures, or pictures one after another
    fps            frames per second; None: what the video says
    moving_camera  find the board in each frame, not in the first alone
    progress       called with the share that is done; < 0: not known
    others         as pictures'
    """
    _check_threads(threads)
    if fps is not None and not fps > 0:
        raise ValueError(f"fps must be frames per second > 0, not {fps}")
    options = _options(dots, tags, dictionary, angles, scale_board, scale, camera, origin, x_axis)
    options.moving_camera = moving_camera
    names = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    if not names:
        raise ValueError("files is empty: give a video, a folder, or pictures")
    _loaded().prepare(threads)
    track: _vision.FilmTrack = _loaded().FilmTrack(options, [os.fspath(name) for name in names], fps)
    while track.advance():
        if progress is not None:
            progress(track.share())
    return Track(track)


def camera(
    pictures: Sequence[PathLike | Image],
    board: str | Board,
    *,
    threads: int = 0,
    progress: ProgressFunction | None = None,
) -> Camera:
    """Camera matrix and lens distortion from pictures of a board under different angles (Zhang 2000).

    pictures  4 or more, better 10 to 20: files, or arrays (h, w, 3) of bytes
    board     'checker,9x6,square=10mm' (squares, not corners) or 'charuco,7x5,square=10mm,tag=7mm'
    raises    InvalidInput where a picture does not show the board, or the angles are too much alike
    """
    _check_threads(threads)
    given = board if isinstance(board, Board) else Board(board)
    _loaded().prepare(threads)
    survey: _vision.CameraSurvey = _loaded().CameraSurvey(given._core)
    _add(survey, pictures, progress)
    survey.fit()
    return _camera(survey.camera(), survey.errors())


def read_camera(file: PathLike) -> Camera:
    """What `Camera.save` or `softkin measure camera` wrote."""
    return _camera(_loaded().Camera.of_file(os.fspath(file)), ())
