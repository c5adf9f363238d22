"""Runs that go record by record: paths of commands and paths of markers."""

from __future__ import annotations

import json
import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Floats, floats
from ._solving import DEFAULT_ITERATIONS, Command, Commands, Solving, _check_map, _options
from .errors import SoftkinWarning
from .shape import Shape
from .table import Table

if TYPE_CHECKING:
    from .maps import KinematicMap
    from .robot import Robot

    AnyRun = _core.PathRun | _core.FollowRun | _core.WalkRun

__all__ = ["FollowRun", "PathRun", "Waypoint"]

PathLike = str | os.PathLike[str]
Steps = PathLike | ArrayLike | Sequence[Mapping[str, Command]]


Record = TypeVar("Record")


class _Run(Iterator[Record]):
    """What all kinds have."""

    _core: AnyRun

    def __init__(self, robot: Robot, core: AnyRun) -> None:
        self._robot = robot
        self._core = core
        _tell(core.remark)

    def __len__(self) -> int:
        """Records in all: steps or waypoints."""
        return self._core.size

    @property
    def done(self) -> int:
        """Records so far."""
        return self._core.done

    def _next_shape(self) -> Shape:
        found = self._core.next()
        if found is None:
            self._core.finish()
            raise StopIteration
        return Shape(self._robot, found)

    @property
    def report(self) -> dict[str, Any]:
        """What `softkin fk --report`, `softkin follow` or `softkin walk` writes, of the records so far."""
        report: dict[str, Any] = json.loads(self._core.report())
        return report

    def finish(self) -> None:
        """Writes report and series of the store, of what there is; at the end of the path that is done by itself."""
        self._core.finish()

    def save_plot(self, path: PathLike) -> None:
        """What the command's --plot draws, of the records so far: an .svg."""
        if self.done == 0:
            raise ValueError("there is nothing to plot: no record is made yet")
        self._core.save_plot(os.fspath(path))


class PathRun(_Run[Shape]):
    """Equilibria along a path of commands, each from the last. Stop when you like."""

    _core: _core.PathRun

    def __next__(self) -> Shape:
        return self._next_shape()

    def __repr__(self) -> str:
        return f"<softkin.PathRun of {self._robot.name}: {self.done} of {len(self)} steps>"


@dataclass(frozen=True)
class Waypoint:
    """Where a path of markers came to."""

    number: int
    """in the path, from 0"""
    shape: Shape
    status: str
    """'reached', 'not reached' or 'not converged'"""
    error_mm: float
    """of the marker that is farthest from its target [mm]"""
    targets: dict[str, list[float | None]]
    """by marker [mm]; None: a coordinate that does not count"""
    equilibria: int
    reason: str
    """why the search stopped, where not reached"""
    time_s: float | None
    inserted: bool
    """between two waypoints that were given"""
    step: dict[str, Any]
    """as the report has it: docs/formats.md"""

    @property
    def reached(self) -> bool:
        return self.status == "reached"

    @property
    def actuation(self) -> dict[str, float]:
        """By the actuator's name."""
        return dict(zip(self.shape.robot.actuators, self.shape.actuation.tolist()))


class FollowRun(_Run[Waypoint]):
    """Inverse kinematics along a path of markers, waypoint by waypoint. Stop when you like."""

    _core: _core.FollowRun

    def __next__(self) -> Waypoint:
        shape = self._next_shape()
        step: dict[str, Any] = json.loads(self._core.step())
        return Waypoint(self.done - 1, shape, *self._core.asked(), step)

    @property
    def commands(self) -> Table:
        """Commands so far: what `softkin follow` writes as commands.csv, and `path` and `softkin drive` take."""
        return Table(self._core.commands())

    @property
    def errors(self) -> Table:
        """Where markers were to go, where they came to, and how far off that is."""
        return Table(self._core.errors())

    def __repr__(self) -> str:
        return f"<softkin.FollowRun of {self._robot.name}: {self.done} of {len(self)} waypoints>"


def _tell(remark: str) -> None:
    if remark and not remark.startswith("there is no "):
        warnings.warn(remark, SoftkinWarning, stacklevel=5)


def _folder(store: PathLike | None) -> str:
    return "" if store is None else os.fspath(store)


def _times(times: ArrayLike | None, rows: int) -> Floats | None:
    if times is None:
        return None
    array = floats("times", times, (rows,))
    if (np.diff(array) <= 0).any():
        raise ValueError("times must ascend")
    return array


class _Runs(Solving):
    """Of a robot."""

    def path(
        self,
        steps: Steps,
        *,
        times: ArrayLike | None = None,
        store: PathLike | None = None,
        map: KinematicMap | None = None,
        polish: bool = False,
        solver: str = "newton",
        tolerance_mm: float | None = None,
        max_iterations: int = DEFAULT_ITERATIONS,
        anderson: int = 6,
        threads: int = 0,
        stable: bool = False,
        as_published: bool = False,
        **commands: Command,
    ) -> PathRun:
        """The shapes along a path of commands, each solved from the last: an iterator.

        steps     (k, m) commands in the order of `robot.actuators`; commands by name for each step; or a CSV file
        times     (k,) [s], ascending
        store     folder of report.json and path.pvd with the shapes: a run that was stopped goes on where it was
        commands  of actuators that the steps do not name
        map       of this robot: answers in the solver's place
        polish    the solver goes on from the map's answers
        others    as solve's
        """
        options = _options(
            solver, tolerance_mm, max_iterations, anderson, threads, stable, as_published=as_published
        )
        core = self._steps("steps", steps, times, commands)
        _check_map(map, polish, options)
        by = None if map is None else map._core
        return PathRun(self._owner, _core.PathRun(self._owner._core, by, polish, core, options, _folder(store)))

    def _steps(self, name: str, steps: Steps, times: ArrayLike | None, others: Mapping[str, Command]) -> _core.Steps:
        """others: commands of actuators that the steps do not name"""
        robot = self._owner
        if isinstance(steps, (str, os.PathLike)):
            if times is not None:
                raise ValueError("times: a file has its own, in column t_s")
            return _core.Steps.of_file(robot._core, os.fspath(steps), [f"{key}={v}" for key, v in others.items()])
        rows: ArrayLike = steps  # type: ignore[assignment]
        if isinstance(steps, Sequence) and steps and isinstance(steps[0], Mapping):
            rows = [self._actuation({**others, **step}, {}) for step in steps]  # type: ignore[dict-item]
        elif others:
            raise ValueError("commands: rows of an array name every actuator")
        table = floats(name, rows, (None, len(robot.actuators)))
        called = "the path" if name == "steps" else "the gait"
        return _core.Steps.of_rows(robot._core, table, _times(times, len(table)), called)

    def follow(
        self,
        path: PathLike | ArrayLike | Mapping[str, ArrayLike],
        *,
        marker: str | None = None,
        times: ArrayLike | None = None,
        max_step_mm: float | None = None,
        start: Commands | None = None,
        workspace: PathLike | None = None,
        samples: int | None = None,
        store: PathLike | None = None,
        predict: bool = True,
        map: KinematicMap | None = None,
        polish: bool = False,
        method: str = "newton",
        tolerance_mm: float | None = None,
        descents: int = 30,
        solver: str = "newton",
        step_tolerance_mm: float | None = None,
        max_iterations: int = DEFAULT_ITERATIONS,
        anderson: int = 6,
        threads: int = 0,
        stable: bool = False,
    ) -> FollowRun:
        """Leads markers along a path: an iterator of waypoints.

        path         (k, 3) places of one marker [mm]; by marker, (k, 3) of each; a column that is NaN does not count;
                     or a CSV file
        marker       whose places they are; None: the robot's only one
        times        (k,) [s], ascending
        max_step_mm  inserts waypoints so that no step is longer [mm]
        start        commands from which the first waypoint is sought; None: rest
        workspace    CSV of a workspace: the first waypoint is sought from its nearest sample
        method       'newton', 'gradient', or 'nearest': without inverse kinematics, each waypoint takes the commands of
                     the nearest sample, of `workspace` or of a grid of so many `samples` over the ranges, which is
                     solved for first
        store        folder as `softkin follow -o` writes it: a run that was stopped goes on where it was
        map, polish  as path's
        tolerance_mm distance from a waypoint at which it is reached [mm]; None: 0.001, gradient 0.2
        others       as inverse's
        """
        robot = self._owner
        statics = _options(solver, step_tolerance_mm, max_iterations, anderson, threads, stable)
        _check_map(map, polish, statics)
        nearest = method == "nearest"
        if nearest and (workspace is None) == (samples is None):
            raise ValueError("method 'nearest' takes the samples of one of workspace and samples")
        if samples is not None and not nearest:
            raise ValueError("samples are those of method 'nearest'")
        inverse = _core.InverseOptions("newton" if nearest else method, tolerance_mm, 200, descents, 3, statics)
        name = "the path"
        if isinstance(path, (str, os.PathLike)):
            if times is not None:
                raise ValueError("times: a file of waypoints has its own, in column t_s")
            name = os.fspath(path)
            places = _core.MarkerPath.of_file(robot._core, name, marker or "")
        else:
            places = self._marker_path(path, marker, times)
        for doubt in places.doubts(robot._core):
            warnings.warn(f"{name}: {doubt}", SoftkinWarning, stacklevel=2)
        if max_step_mm is not None:
            places = places.densified(max_step_mm)
        begin = None if start is None else self._actuation(start, {})
        core = _core.FollowRun(
            robot._core,
            None if map is None else map._core,
            polish,
            places,
            name,
            inverse,
            predict,
            begin,
            "" if workspace is None else os.fspath(workspace),
            nearest,
            samples,
            _folder(store),
        )
        return FollowRun(robot, core)

    def _marker_path(
        self, path: ArrayLike | Mapping[str, ArrayLike], marker: str | None, times: ArrayLike | None
    ) -> _core.MarkerPath:
        robot = self._owner
        if not isinstance(path, Mapping):
            if marker is None:
                if len(robot.markers) != 1:
                    raise ValueError(f"marker: the robot has {len(robot.markers)} markers; say whose path it is")
                marker = robot.markers[0]
            path = {marker: path}
        arrays = [floats(f"path: {name}", values, (None, 3), nan=True) for name, values in path.items()]
        if not arrays or any(len(array) != len(arrays[0]) for array in arrays):
            raise ValueError("path: every marker needs as many places as the others, at least one")
        axes: list[tuple[bool, bool, bool]] = []
        for name, array in zip(path, arrays):
            missing: NDArray[np.bool_] = np.isnan(array)
            if (missing.any(axis=0) != missing.all(axis=0)).any():
                raise ValueError(f"path: {name}: a coordinate counts at every waypoint or (all NaN) at none")
            x, y, z = (not missing[:, axis].all() for axis in range(3))
            if not (x or y or z):
                raise ValueError(f"path: {name}: no coordinate counts")
            axes.append((bool(x), bool(y), bool(z)))
        targets = np.ascontiguousarray(np.nan_to_num(np.stack(arrays, axis=1)))
        return _core.MarkerPath.of_targets(robot._core, list(path), targets, axes, _times(times, len(targets)))
