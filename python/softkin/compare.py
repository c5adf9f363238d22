"""Reports of the same steps side by side, and predicted beside measured paths."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Generic, TypeVar

import numpy as np

from . import _core
from ._arrays import Floats
from ._core import InvalidInput
from ._files import PathLike, listed
from ._of_robot import parsed
from .table import Table

__all__ = ["PathComparison", "ReportComparison", "paths", "reports"]


def _files(name: str, files: Sequence[PathLike], least: int = 2) -> list[str]:
    if isinstance(files, (str, os.PathLike)) or len(files) < least:
        raise InvalidInput(f"{name} must be a list of {least} files or more")
    return listed(files)


Core = TypeVar("Core", _core.ReportComparison, _core.PathReport)


class _Comparison(Generic[Core]):
    """The base class of both comparisons."""

    def __init__(self, core: Core) -> None:
        self._core: Core = core

    @property
    def report(self) -> dict[str, Any]:
        """What `softkin compare --json` prints."""
        return parsed(self._core.json())

    def save_plot(self, path: PathLike) -> None:
        """Writes an .svg: of reports turns, distances and loads over the steps, and marker trajectories; of paths the
        trajectories only."""
        self._core.save_plot(os.fspath(path))


class ReportComparison(_Comparison[_core.ReportComparison]):
    """Reports of the same steps; the first is the one to compare with."""

    @property
    def marker(self) -> str:
        """The marker whose distance is reported."""
        return self._core.marker

    @property
    def distances(self) -> Floats:
        """(r, k) of the marker from that of the first report, per report and step [mm]."""
        return np.array(self._core.distances)

    @property
    def turns(self) -> Floats:
        """(r, k) of the line between two markers since the first step [degrees]; (0, ) where not requested."""
        return np.array(self._core.turns)

    @property
    def steps(self) -> Table:
        return Table(self._core.steps())

    @property
    def times(self) -> Table:
        """How long each took, until the poses and in all."""
        return Table(self._core.times())

    def __repr__(self) -> str:
        return repr(self.steps)

    def _repr_html_(self) -> str:
        return self.steps._repr_html_() + self.times._repr_html_()


class PathComparison(_Comparison[_core.PathReport]):
    """Paths of a marker beside a reference, the first."""

    @property
    def heads(self) -> list[str]:
        """What each path is and how it is compared."""
        return self._core.heads()

    @property
    def waypoints(self) -> Table:
        """How far off each path is; of long paths twenty even rows."""
        return Table(self._core.waypoints())

    @property
    def summary(self) -> Table:
        """Largest, mean and root mean square distance."""
        return Table(self._core.summary())

    @property
    def errors(self) -> Table:
        """Every waypoint with its error."""
        return Table(self._core.errors())

    def __repr__(self) -> str:
        return repr(self.summary)

    def _repr_html_(self) -> str:
        return self.summary._repr_html_()


def reports(
    files: Sequence[PathLike],
    *,
    marker: str | None = None,
    turn: tuple[str, str] | None = None,
    poses: Sequence[float] = (),
) -> ReportComparison:
    """Reports of the same steps side by side.

    files   reports of `softkin fk --report` or of paths (their store's report.json); the first is the one to compare with
    marker  the marker whose distance is reported; None: the first
    turn    two markers: by how much the line from one to the other has turned since the first step
    poses   with turn: the time until each of these turns is reached [degrees]
    """
    if len(poses) and turn is None:
        raise InvalidInput("poses need turn, which says what turns")
    core = _core.compare_reports(_files("files", files), marker or "", list(turn or ()), list(poses))
    return ReportComparison(core)


def paths(
    files: Sequence[PathLike],
    *,
    marker: str | None = None,
    by: str | None = None,
    plane: str | None = None,
    start_s: float | None = None,
    align: bool = False,
    sum_of: Sequence[PathLike] = (),
) -> PathComparison:
    """Predicted beside measured paths of a marker.

    files    reports and tracks (CSV with t_s, x_mm, y_mm, z_mm or tip_x_mm, ...; "F.csv@tip" chooses a marker); the
             first is the one to compare with
    by       which points belong together: 'time', 'waypoint', 'arc', or a column or actuator that ascends
    plane    axes of the robot that the two coordinates of a flat track are, such as 'xz'; 'x-z': the second turned round
    start_s  when the first file's clock begins, in that of the tables after it [s]
    align    first turn and move each track onto the first
    sum_of   reports in which one actuator moves each: adds the sum of their displacements
    """
    given = _files("files", files, 1 if sum_of else 2)
    return PathComparison(
        _core.compare_paths(given, listed(sum_of), marker or "", by or "", plane or "", start_s, align)
    )
