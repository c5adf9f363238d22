"""Runs that go record by record: paths of commands and paths of markers."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Floats, floats
from ._compiled import Command, Compiled
from ._core import InvalidInput
from ._files import PathLike
from ._kinds import named_file, shown
from ._of_robot import OfRobot, parsed
from ._warning import warn
from .shape import Shape, warn_of
from .table import Table

__all__ = ["FollowRun", "PathRun", "Waypoint"]

Steps = PathLike | ArrayLike | Sequence[Mapping[str, Command]]
Core = TypeVar("Core", _core.PathRun, _core.FollowRun, _core.WalkRun)
Record = TypeVar("Record")


class _Run(OfRobot[Core], Iterator[Record]):
    """What all kinds have."""

    def __len__(self) -> int:
        """Records in all: steps or waypoints."""
        return self._core.size

    @property
    def done(self) -> int:
        """Records so far."""
        return self._core.done

    _records = "step"

    @cached_property
    def _raised(self) -> set[int]:
        """Kinds of warnings that were raised, each once."""
        return set()

    def _next_shape(self) -> Shape:
        found = self._core.next()
        if found is None:
            self._core.finish()
            raise StopIteration
        warn_of(self._core.findings(), self._raised, f"{self._records} {max(0, self.done - 1)}: ")
        return Shape(self._robot, found)

    @property
    def report(self) -> dict[str, Any]:
        """What `softkin fk --report`, `softkin follow` or `softkin walk` writes, of the records so far."""
        return parsed(self._core.report())

    def turns(self, marker: str, to: str | None = None) -> Floats:
        """(done,) by how much the line from a marker to another one has turned from rest in each record so far
        [degrees]; what `softkin fk --turn` prints and plots. Arguments as those of `Shape.turn`.
        """
        return np.array(self._core.turns(marker, to), dtype=float)

    def finish(self) -> None:
        """Writes report and series of the store, of what there is; at the end of the path that is done by itself."""
        self._core.finish()

    def save_plot(self, path: PathLike) -> None:
        """What the command's --plot draws, of the records so far: an .svg."""
        if self.done == 0:
            raise InvalidInput("there is nothing to plot: no record is made yet")
        self._core.save_plot(os.fspath(path))


class PathRun(_Run[_core.PathRun, Shape]):
    """Equilibria along a path of commands, each from the last. Stop when you like."""

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


class FollowRun(_Run[_core.FollowRun, Waypoint]):
    """Inverse kinematics along a path of markers, waypoint by waypoint. Stop when you like."""

    _records = "waypoint"

    def __next__(self) -> Waypoint:
        shape = self._next_shape()
        return Waypoint(self.done - 1, shape, *self._core.asked(), parsed(self._core.step()))

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


def times_of(times: ArrayLike | None, rows: int) -> Floats | None:
    if times is None:
        return None
    array = floats("times", times, (rows,))
    if (np.diff(array) <= 0).any():
        raise InvalidInput("times must ascend")
    return array


def steps_of(
    robot: Compiled, name: str, steps: Steps, times: ArrayLike | None, others: Mapping[str, Command]
) -> _core.Steps:
    """others: commands of actuators that the steps do not name"""
    if isinstance(steps, (str, os.PathLike)):
        named_file(name, steps)
        if times is not None:
            raise InvalidInput("times: a file has its own, in column t_s")
        return _core.Steps.of_file(robot._core, os.fspath(steps), [f"{key}={v}" for key, v in others.items()])
    rows: ArrayLike = steps  # type: ignore[assignment]
    if isinstance(steps, Sequence) and steps and isinstance(steps[0], Mapping):
        for i, step in enumerate(steps):
            if not isinstance(step, Mapping):
                raise InvalidInput(f"{name}[{i}] must be a dictionary as the steps before it, not {shown(step)}")
        rows = [robot._actuation(step, others) for step in steps]
    elif others:
        raise InvalidInput("commands: rows of an array name every actuator")
    table = floats(name, rows, (None, len(robot.actuators)))
    called = "the path" if name == "steps" else "the gait"
    return _core.Steps.of_rows(robot._core, table, times_of(times, len(table)), called)


def remarked(core: Core) -> Core:
    """A run that was begun, with what there is to say of it."""
    if core.remark and not core.remark.startswith("there is no "):
        warn(core.remark)
    return core


def waypoints_of(
    robot: Compiled,
    path: PathLike | ArrayLike | Mapping[str, ArrayLike],
    marker: str | None,
    times: ArrayLike | None,
    max_step_mm: float | None,
) -> tuple[_core.MarkerPath, str]:
    """And what they are called."""
    name = "the path"
    if isinstance(path, (str, os.PathLike)):
        named_file("path", path)
        if times is not None:
            raise InvalidInput("times: a file of waypoints has its own, in column t_s")
        name = os.fspath(path)
        places = _core.MarkerPath.of_file(robot._core, name, marker or "")
    else:
        places = _marker_path(robot, path, marker, times)
    for doubt in places.doubts(robot._core):
        warn(f"{name}: {doubt}")
    return (places if max_step_mm is None else places.densified(max_step_mm)), name


def _marker_path(
    robot: Compiled, path: ArrayLike | Mapping[str, ArrayLike], marker: str | None, times: ArrayLike | None
) -> _core.MarkerPath:
    if not isinstance(path, Mapping):
        if marker is None:
            if len(robot.markers) != 1:
                raise InvalidInput(f"marker: the robot has {len(robot.markers)} markers; say whose path it is")
            marker = robot.markers[0]
        path = {marker: path}
    arrays = [floats(f"path: {name}", values, (None, 3), nan=True) for name, values in path.items()]
    if not arrays or any(len(array) != len(arrays[0]) for array in arrays):
        raise InvalidInput("path: every marker needs as many places as the others, at least one")
    axes: list[tuple[bool, bool, bool]] = []
    for name, array in zip(path, arrays):
        missing: NDArray[np.bool_] = np.isnan(array)
        if (missing.any(axis=0) != missing.all(axis=0)).any():
            raise InvalidInput(f"path: {name}: a coordinate counts at every waypoint or (all NaN) at none")
        x, y, z = (not missing[:, axis].all() for axis in range(3))
        if not (x or y or z):
            raise InvalidInput(f"path: {name}: no coordinate counts")
        axes.append((bool(x), bool(y), bool(z)))
    targets = np.ascontiguousarray(np.nan_to_num(np.stack(arrays, axis=1)))
    return _core.MarkerPath.of_targets(robot._core, list(path), targets, axes, times_of(times, len(targets)))
