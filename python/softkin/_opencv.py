"""The functions of OpenCV's package for Python that softkin.measure uses: src/softkin/vision/open_cv.hpp.

Called by softkin._vision. Pictures are (h, w) or (h, w, 3) of bytes, points (n, 2) x, y [pixel].
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Floats = NDArray[np.float64]


def version() -> tuple[int, int]:
    major, minor = cv2.__version__.split(".")[:2]
    return int(major), int(minor)


if version() < (4, 10):
    raise ImportError(f"its version {cv2.__version__} is older than 4.10")


def prepare(threads: int) -> None:
    logging = getattr(cv2.utils, "logging", None)  # there since 4.12
    (logging or cv2).setLogLevel(0)
    os.environ.setdefault("OPENCV_FFMPEG_LOGLEVEL", "-8")
    if threads > 0:
        cv2.setNumThreads(threads)


def decoded(content: bytes) -> Bytes | None:
    try:
        bgr = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_COLOR)
    except cv2.error:
        return None
    return None if bgr is None else _rgb(bgr)


def _rgb(bgr: Any) -> Bytes:
    return np.ascontiguousarray(cv2.cvtColor(bgr, cv2.COLOR_BGR2RGB), np.uint8)


class Video:
    """Raises ValueError where the file is no video that can be read."""

    def __init__(self, file: str) -> None:
        self.capture = cv2.VideoCapture(file)
        if not self.capture.isOpened():
            raise ValueError(file)
        self.rate = float(self.capture.get(cv2.CAP_PROP_FPS))
        self.frames = float(self.capture.get(cv2.CAP_PROP_FRAME_COUNT))

    def next(self) -> Bytes | None:
        there, bgr = self.capture.read()
        return _rgb(bgr) if there and bgr is not None else None


def open_video(file: str) -> Video | None:
    try:
        return Video(file)
    except (ValueError, cv2.error):
        return None


def dictionary(number: int) -> tuple[int, int]:
    tags = cv2.aruco.getPredefinedDictionary(number)
    return len(tags.bytesList), tags.markerSize


def tag_squares(dictionary: int, tag: int) -> bytes:
    tags = cv2.aruco.getPredefinedDictionary(dictionary)
    return np.asarray(tags.generateImageMarker(tag, tags.markerSize + 2), np.uint8).tobytes()


def find_tags(picture: Bytes, dictionary: int) -> tuple[list[int], Floats]:
    """Numbers, and (n, 8) the corners of each."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_NONE
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(dictionary), parameters)
    corners, numbers, _ = detector.detectMarkers(picture)
    found = [] if numbers is None else [int(number) for number in np.ravel(numbers)]
    return found, _rows([np.ravel(four) for four in corners], 8)


def _rows(rows: Sequence[Any], columns: int) -> Floats:
    return np.ascontiguousarray(np.asarray(rows, np.float64).reshape(-1, columns))


def chessboard(picture: Bytes, columns: int, rows: int) -> Floats | None:
    found, corners = cv2.findChessboardCornersSB(picture, (columns, rows), flags=cv2.CALIB_CB_ACCURACY)
    return _rows(corners, 2) if found else None


def crossings(picture: Bytes, rough: Floats, reach: int) -> Floats:
    ends = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-3)
    corners = np.ascontiguousarray(rough, np.float32).reshape(-1, 1, 2)
    return _rows(cv2.cornerSubPix(picture, corners, (reach, reach), (-1, -1), ends), 2)


def calibrated(
    places: Sequence[Floats], pixels: Sequence[Floats], width: int, height: int
) -> tuple[list[float], list[float], Floats] | None:
    """Of the boards' points (n, 2) [mm] and where they are seen [pixel].

    Returns fx, fy, cx, cy, k1, k2, p1, p2, the standard errors of fx and fy and the reprojection error; the error of each
    picture; (pictures, 3) rotations.
    """
    flat = [np.column_stack([place, np.zeros(len(place))]).astype(np.float32) for place in places]
    seen = [np.ascontiguousarray(pixel, np.float32) for pixel in pixels]
    try:
        error, matrix, lens, turns, _, spread, _, errors = cv2.calibrateCameraExtended(
            flat, seen, (width, height), np.eye(3), np.zeros(5), flags=cv2.CALIB_FIX_K3
        )
    except cv2.error:
        return None
    # These versions count x and y of a corner as two observations, 4.6 as one, which makes larger errors: blur and an uneven
    # board move both at once. softkin reports the larger errors everywhere.
    count, unknowns = sum(map(len, places)), 8 + 6 * len(places)
    spreads = np.ravel(spread) * (np.sqrt((2 * count - unknowns) / (count - unknowns)) if count > unknowns else np.inf)
    numbers = [*(matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]), *np.ravel(lens)[:4], *spreads[:2], error]
    return [float(number) for number in numbers], [float(each) for each in np.ravel(errors)], _rows(turns, 3)
