"""Walks: gaits with feet of direction-dependent friction. docs/walking.md"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _core
from ._arrays import Floats
from ._of_robot import parsed
from .runs import _Run
from .shape import Shape
from .table import Table

__all__ = ["WalkRun", "WalkStep"]


@dataclass(frozen=True)
class WalkStep:
    """A step of a walk."""

    number: int
    """of the step, from 0"""
    cycle: int
    """from 1; 0: where the robot is put down"""
    shape: Shape
    """where the robot has walked to"""
    sliding: str
    """what has slid since the step before: 'none', 'rear', 'front' or 'both'"""
    friction_N: float | None
    """with which the feet stretch the body, < 0: press it together; None: target shapes have no forces"""
    feet_mm: dict[str, float]
    """of the rear and the front foot along the direction of travel, from where the rear one stood at rest"""
    travel_mm: float
    """of the middle between the feet, from where it stood first"""
    equilibria: int
    """solved for this step"""
    time_s: float | None
    step: dict[str, Any]
    """as the report has it: docs/formats.md"""

    @property
    def status(self) -> str:
        """'converged'; of the last step of a walk that ends early 'not converged' or 'limit'."""
        return self.shape.status


class WalkRun(_Run[_core.WalkRun, WalkStep]):
    """A gait that is walked, step by step. Stop when you like. A step without an equilibrium is the last one."""

    def __next__(self) -> WalkStep:
        number = self.done
        shape = self._next_shape()
        step = parsed(self._core.step())
        walk = step["walk"]
        return WalkStep(
            number,
            walk["cycle"],
            shape,
            walk["sliding"],
            walk.get("friction_N"),
            walk["feet_mm"],
            walk["travel_mm"],
            walk["equilibria"],
            step.get("time_s"),
            step,
        )

    @property
    def direction(self) -> Floats:
        """(3,) of travel: from the rear foot to the front one at rest, of length 1."""
        return np.array(self._core.direction())

    @property
    def strides_mm(self) -> Floats:
        """(c,) what the middle between the feet moved in each finished cycle [mm]; the first one differs."""
        return np.array(self._core.strides())

    @property
    def steps(self) -> Table:
        """Steps so far: what `softkin walk` writes as walk.csv."""
        return Table(self._core.table())

    def __repr__(self) -> str:
        return f"<softkin.WalkRun of {self._robot.name}: {self.done} of {len(self)} steps>"
