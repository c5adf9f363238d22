"""Inverse kinematics: goals, search, answer."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from . import _core
from ._arrays import Floats, dimensions, vector
from ._compiled import Command, Commands, Compiled
from ._core import Answer as CoreAnswer
from ._core import Shape as CoreShape
from ._core import InvalidInput
from ._files import PathLike
from ._kinds import nearest, shown
from ._of_robot import parsed
from ._saving import Saving
from ._warning import warn
from .shape import NotConverged, Shape
from .solver import ProgressFunction, progress_callback

__all__ = ["Answer"]

Target = Sequence[float | None] | Floats


class Answer(Saving[CoreAnswer]):
    """The result of inverse kinematics."""

    @cached_property
    def shape(self) -> Shape:
        """The equilibrium at the best actuation found."""
        return Shape(self._robot, self._core.shape)

    @property
    def actuation(self) -> dict[str, float]:
        """By the actuator's name, inside every range: ratio [-], tension [N], pressure [kPa] or voltage [kV]."""
        return dict(zip(self._robot.actuators, self.shape.actuation.tolist()))

    @property
    def status(self) -> str:
        """'reached', 'not reached', 'not converged' or 'interrupted'."""
        return self._core.status

    @property
    def reached(self) -> bool:
        """Is every goal met?"""
        return self._core.reached

    @property
    def reason(self) -> str:
        """Why it stopped, where not reached."""
        return self._core.remark

    @property
    def errors_mm(self) -> Floats:
        """(g,) of each goal of markers [mm], in the order in which they were given: targets, planes, directions."""
        return self._core.errors_mm

    @property
    def errors_N(self) -> Floats:
        """(f,) of each force of `press` [N], in the order in which they were given."""
        return self._core.errors_N

    @property
    def error_mm(self) -> float:
        """The largest error of a marker goal [mm]; NaN where there is none, or the start has no equilibrium."""
        errors = self.errors_mm
        return float(errors.max()) if len(errors) else float("nan")

    @property
    def error_N(self) -> float:
        """The largest error of a force [N]; NaN where no force is requested, or the start has no equilibrium."""
        errors = self.errors_N
        return float(errors.max()) if len(errors) else float("nan")

    @property
    def at_end_of_range(self) -> dict[str, str]:
        """Actuators that stand at an end of their range and are pushed there: 'low' or 'high'."""
        ends = zip(self._robot.actuators, self._core.at_end)
        return {name: "low" if end < 0 else "high" for name, end in ends if end != 0}

    @property
    def equilibria(self) -> int:
        """That were solved for."""
        return self._core.equilibria

    @property
    def iterations(self) -> int:
        return self._core.iterations

    @property
    def seconds(self) -> float:
        """Of the search [s]."""
        return self._core.seconds

    @cached_property
    def report(self) -> dict[str, Any]:
        """What `softkin ik --report` writes: docs/formats.md."""
        return parsed(self._core.report())

    def _core_shape(self) -> CoreShape:
        return self._core.shape

    def _title(self) -> str:
        title = f"{self._robot.name}: {self.status}"
        return title + f", {self._core.off} off" if self._core.has_shape else title

    def save_plot(self, path: str | os.PathLike[str]) -> None:
        """The error over the equilibria of the search: an .svg."""
        if not self._core.has_shape:
            raise InvalidInput(f"there is nothing to plot: {self.reason}")
        self._core.save_plot(os.fspath(path))

    def require(self) -> Answer:
        """Itself; raises NotConverged where not every goal is met."""
        if self.reached:
            return self
        raise NotConverged(f"{self.status}, {self._core.off or 'nan mm'} off: {self.reason}", self.shape)

    def __repr__(self) -> str:
        if not self._core.has_shape:
            return f"<softkin.Answer {self.status}: {self.reason}>"
        commands = ", ".join(
            f"{info.name}={info.command_text(value)}"
            for info, value in zip(self._robot.actuator_infos, self.shape.actuation)
        )
        return f"<softkin.Answer {self.status}, {self._core.off} off: {commands}>"


ARGUMENTS: tuple[str, ...] = ("planes", "directions", "lever_mm", "press", "weights", "start", "workspace", "prefer", "fix", "map")
ARGUMENTS += ("polish", "method", "tolerance_mm", "tolerance_force_N", "max_equilibria", "descents", "other_starts")
ARGUMENTS += ("solver", "elapsed_s", "budget_s", "progress")
"""of inverse(), beside markers"""


def places_of(
    robot: Compiled, targets: Mapping[str, Target] | None, markers: Mapping[str, Target]
) -> dict[str, Target]:
    """Where markers are to be, given by name, as keywords, or some of them so and some so."""
    for name in markers:
        if targets is not None and name in targets:
            raise InvalidInput(f"the target of {name!r} is given twice: among the targets and as a keyword")
        if name not in robot._markers:
            near = nearest(name, [*robot._markers, *ARGUMENTS])
            if not any(argument in near for argument in ARGUMENTS):
                robot._core.marker(name)  # raises with the nearest name
            raise InvalidInput(f"inverse has no argument {name!r}, and the robot no marker of that name{near}")
    return {**(targets or {}), **markers}


def counted(what: str, of: str, target: Target) -> tuple[tuple[float, float, float], tuple[bool, bool, bool]]:
    """Three numbers, zero where one does not count, and which do."""
    if not isinstance(target, (Sequence, np.ndarray)) or isinstance(target, (str, bytes)) or dimensions(what, target) == 0:
        raise InvalidInput(f"{what} must be three {of}, not {shown(target)}")
    if len(target) != 3:
        raise InvalidInput(f"{what} must be three {of}, not {len(target)}")
    axes = [value is not None for value in target]
    return vector(what, [0.0 if value is None else value for value in target]), (axes[0], axes[1], axes[2])


def goals_of(
    robot: Compiled,
    targets: Mapping[str, Target],
    planes: Mapping[str, tuple[Sequence[float], Sequence[float]]] | None,
    directions: Mapping[tuple[str, str], Sequence[float]] | None,
    lever_mm: float | None,
    press: Mapping[str, Target] | None,
    tolerances: tuple[float, float | None],
    weights: Mapping[str | tuple[str, str], float] | None,
) -> _core.Goals:
    left = dict(weights or {})
    goals = _core.Goals(robot._core)
    named = {name: left.get(name, 1.0) for name in press or {}}
    for marker, target in targets.items():
        place, axes = counted(f"the target of {marker!r}", "coordinates [mm]", target)
        goals.position(marker, place, axes, left.pop(marker, 1.0))
    for marker, (point, normal) in (planes or {}).items():
        goals.plane(marker, vector("planes: point", point), vector("planes: normal", normal), left.pop(marker, 1.0))
    for (first, second), direction in (directions or {}).items():
        weight = left.pop((first, second), 1.0)
        goals.direction(first, second, vector("directions", direction), lever_mm, weight)
    for name, requested in (press or {}).items():
        force, axes = counted(f"press: the force on {name!r}", "components [N]", requested)
        goals.press(name, force, axes, *tolerances, named[name])
        left.pop(name, None)
    if left:
        raise InvalidInput(f"weights: there is no goal for {next(iter(left))!r}")
    for doubt in goals.check():
        warn(doubt)
    return goals


def start_of(goals: _core.Goals, start: Shape | Commands | None, workspace: PathLike | None) -> Shape | Commands | None:
    if workspace is None:
        return start
    if start is not None:
        raise InvalidInput("workspace chooses the start: it does not go with start")
    return goals.nearest_sample(os.fspath(workspace))


def searched(
    robot: Compiled,
    goals: _core.Goals,
    start: Shape | Commands | None,
    last: Answer | None,
    prefer: Mapping[str, Command] | None,
    fix: Mapping[str, Command] | Sequence[str] | None,
    by: _core.Session | None,
    options: _core.InverseOptions,
    progress: ProgressFunction | None,
) -> CoreAnswer:
    fixed = dict(fix) if isinstance(fix, Mapping) else dict.fromkeys(fix or ())
    values = {name: value for name, value in fixed.items() if value is not None}
    free = [info.name not in fixed for info in robot.actuator_infos]
    for name in fixed:
        robot._place(name)
        if name in (prefer or {}):
            raise InvalidInput(f"fix: {name!r} does not change, so it takes no prefer")
    shape = start if isinstance(start, Shape) else None
    if shape is not None and values:
        raise InvalidInput("fix: with start=shape an actuator stays as it is there; give names without values")
    begin = None if shape is not None else robot._with(robot._actuation(start, {}), values)  # type: ignore[arg-type]
    preferred = None
    if prefer:
        preferred = (shape.actuation if shape is not None else begin).copy()  # type: ignore[union-attr]
        for name, value in prefer.items():
            preferred[robot._place(name)] = robot._number(name, value)
    return _core.inverse(
        goals,
        by,
        begin,
        None if shape is None else shape._core,
        None if last is None else last._core,
        preferred,
        free,
        options,
        None if progress is None else progress_callback(progress),
    )
