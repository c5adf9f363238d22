"""Answers of inverse kinematics."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING, Any

from . import _core
from ._arrays import Floats
from ._core import Answer as CoreAnswer
from ._core import Shape as CoreShape
from ._saving import Saving
from .errors import NotConverged
from .shape import Shape

if TYPE_CHECKING:
    from .robot import Robot

__all__ = ["Answer"]


class Answer(Saving):
    """What inverse kinematics came to."""

    _core: CoreAnswer

    def __init__(self, robot: Robot, core: CoreAnswer) -> None:
        self._robot = robot
        self._core = core

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
        """(g,) of each goal [mm], in the order in which they were given: targets, planes, directions."""
        return self._core.errors_mm

    @property
    def error_mm(self) -> float:
        """Of the farthest goal [mm]; NaN where the start has no equilibrium."""
        errors = self.errors_mm
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
        report: dict[str, Any] = json.loads(self._core.report())
        return report

    def _core_shape(self) -> CoreShape:
        return self._core.shape

    def _title(self) -> str:
        title = f"{self._robot.name}: {self.status}"
        return title + f", {self.error_mm:.2g} mm off" if self._core.has_shape else title

    def save_plot(self, path: str | os.PathLike[str]) -> None:
        """The error over the equilibria of the search: an .svg."""
        if not self._core.has_shape:
            raise ValueError(f"there is nothing to plot: {self.reason}")
        self._core.save_plot(os.fspath(path))

    def require(self) -> Answer:
        """Itself; raises NotConverged where not every goal is met."""
        if self.reached:
            return self
        raise NotConverged(f"{self.status}, {self.error_mm:.3g} mm off: {self.reason}", self.shape)

    def __reduce__(self) -> tuple[Callable[[Robot, bytes], Answer], tuple[Robot, bytes]]:
        return _unpickled, (self._robot, self._core.pickled())

    def __repr__(self) -> str:
        if not self._core.has_shape:
            return f"<softkin.Answer {self.status}: {self.reason}>"
        commands = ", ".join(
            f"{info.name}={info.command_text(value)}"
            for info, value in zip(self._robot.actuator_infos, self.shape.actuation)
        )
        return f"<softkin.Answer {self.status}, {self.error_mm:.3g} mm off: {commands}>"


def _unpickled(robot: Robot, state: bytes) -> Answer:
    return Answer(robot, _core.Answer.unpickled(robot._core, state))
