"""Markers, specimens, angles and tracks in mm, out of pictures and films: docs/measure.md.

Needs OpenCV's package for Python: `pip install 'softkin[measure]'`; `available()` reports whether it is installed.
"""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats, floats
from ._core import InvalidInput
from ._files import PathLike, write
from ._measured import Angle, MarkerPlace, Outline, Picture, Pictures, Specimen, Stretch, Track

if TYPE_CHECKING:
    import softkin._vision as _vision

__all__ = [
    "Angle",
    "Board",
    "Camera",
    "MarkerPlace",
    "Outline",
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

Image = NDArray[np.uint8]
ProgressFunction = Callable[[float], object]
Point = str | tuple[float, float]

INSTALL = "needs OpenCV's package for Python, 4.10 or later: pip install 'softkin[measure]'"


def available() -> bool:
    """Is OpenCV's package for Python there, and does it load?"""
    try:
        _loaded()
    except ImportError:
        return False
    return True


def _loaded() -> Any:
    """The part on OpenCV, which takes a third of a second to load: not before it is needed."""
    try:
        importlib.import_module("softkin._opencv")
    except ImportError as error:
        raise ImportError(f"softkin.measure {INSTALL} ({error})") from None
    return importlib.import_module("softkin._vision")


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
        write(path, self._core().text())

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
            write(file, self.svg())
        elif file.suffix.lower() == ".png":
            write(file, self._core.png(dpi))
        else:
            raise InvalidInput(f"path must end in .svg or .png, not {file.name!r}")

    def __repr__(self) -> str:
        return f"<softkin.measure.Board {self.text}: {self.width_mm:g} x {self.height_mm:g} mm>"


def _check_dpi(dpi: float) -> None:
    if not 10 <= dpi <= 4800:
        raise InvalidInput(f"dpi must be 10 to 4800 dots per inch, not {dpi}")


def _named(name: str, given: str | Sequence[object] | Mapping[str, object] | None) -> str:
    """As the command takes it: red,tip=blue."""
    if given is None or isinstance(given, str):
        return given or ""
    if isinstance(given, Mapping):
        return ",".join(f"{key}={value}" for key, value in given.items())
    if len(given) == 0:
        raise InvalidInput(f"{name} is empty")
    return ",".join(str(value) for value in given)


def _scale(given: str | tuple[Point, Point, float] | None) -> str:
    if given is None or isinstance(given, str):
        return given or ""
    if len(given) != 3:
        raise InvalidInput(f"scale must be two markers or two pixels and their distance [mm], not {given!r}")
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
        raise InvalidInput(f"angles must be a list such as [('a', 'b')], not {angles!r}")
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
        raise InvalidInput(f"threads must be 0 (one a core) to 1024, not {threads}")


def _add(
    series: _vision.PhotoSeries | _vision.CameraSurvey,
    given: Sequence[PathLike | Image],
    progress: ProgressFunction | None,
) -> None:
    if isinstance(given, (str, os.PathLike)) or len(given) == 0:
        raise InvalidInput("pictures must be a list of one or more: files, or arrays (h, w, 3) of bytes")
    for number, picture in enumerate(given):
        if progress is not None:
            progress(number / len(given))
        if isinstance(picture, (str, os.PathLike)):
            series.add_file(os.fspath(picture))
            continue
        name = f"pictures[{number}]"
        array = np.asarray(picture)
        if array.dtype != np.uint8 or array.ndim != 3 or array.shape[2] != 3:
            raise InvalidInput(f"{name} must be (h, w, 3) of uint8: red, green, blue; not {array.shape} of {array.dtype}")
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
    outline: str | None = None,
    angles: Sequence[str | Sequence[str]] = (),
    scale_board: str | Board | None = None,
    scale: str | tuple[Point, Point, float] | None = None,
    camera: PathLike | Camera | None = None,
    origin: str | None = None,
    x_axis: str | tuple[str, str] | None = None,
    threads: int = 0,
    progress: ProgressFunction | None = None,
) -> Pictures:
    """Markers, angles, specimens and outlines of photographs. One of scale_board and scale is needed.

    pictures     files (PNG, JPEG, TIFF, ...), or arrays (h, w, 3) of bytes: red, green, blue
    dots         round dots of a colour each: {"tip": "blue"}, ["red", "green"], or a text: "red,tip=blue"
    tags         centres of ArUco tags: True for all in the first picture, {"tip": 7}, or [3, 7]
    dictionary   of the tags: '4x4_50' to '7x7_1000', 'original'; None: that of the board, else '4x4_50'
    interface    colours of a bar of two materials, that at the fixed end first: ("red", "blue")
    outline      the outer outline of the largest part of a colour, or of what is 'dark' or 'bright' against the ground;
                 its table is what softkin.calibrate.robot takes
    angles       of lines between markers: ("a", "b") against x, ("a", "b", "c", "d") of c to d against a to b
    scale_board  a printed board in the plane of the markers: '5x4,tag=12mm,gap=3mm', 'charuco,7x5,square=10mm,tag=7mm'
    scale        two markers, or two pixels (x, y), and their distance [mm]: ("a", "b", 25)
    camera       lens distortion to take out: what camera() returns, or its file
    origin       marker that is the origin, where it is in the first picture
    x_axis       markers from which to which x goes, in the first picture
    threads      of OpenCV; 0: one a core
    progress     called with the completed fraction
    raises       InvalidInput naming the picture: a marker not found, or found twice, ...
    """
    _check_threads(threads)
    options = _options(dots, tags, dictionary, angles, scale_board, scale, camera, origin, x_axis)
    options.interface = _named("interface", interface)
    options.outline = outline or ""
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
    progress       called with the completed fraction; < 0: not known
    others         as pictures'
    """
    _check_threads(threads)
    if fps is not None and not fps > 0:
        raise InvalidInput(f"fps must be frames per second > 0, not {fps}")
    options = _options(dots, tags, dictionary, angles, scale_board, scale, camera, origin, x_axis)
    options.moving_camera = moving_camera
    names = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    if not names:
        raise InvalidInput("files is empty: give a video, a folder, or pictures")
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
