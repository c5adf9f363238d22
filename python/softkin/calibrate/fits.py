"""The base class of calibrations."""

from __future__ import annotations

import os
from typing import Any, Generic, TypeVar

from .. import _core
from .._files import PathLike
from .._of_robot import parsed

Core = TypeVar("Core", bound=_core.Calibration | _core.CurveCalibration | _core.RobotCalibration)


class Fit(Generic[Core]):
    """Fitted parameters, and how they were determined."""

    def __init__(self, core: Core) -> None:
        self._core = core

    @property
    def report(self) -> dict[str, Any]:
        """What the command's --json prints."""
        return parsed(self._core.json)

    def save_plot(self, path: PathLike) -> None:
        """Measured and fitted: an .svg."""
        self._core.save_plot(os.fspath(path))

    def __repr__(self) -> str:
        return self._core.text.rstrip("\n")
