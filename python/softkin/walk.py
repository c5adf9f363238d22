"""Walks: a gait with feet that slide one way better than the other. docs/walking.md"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats
from ._solving import DEFAULT_ITERATIONS, _options
from .runs import PathLike, Steps, _folder, _Run, _Runs
from .shape import Shape
from .table import Table

__all__ = ["WalkRun", "WalkStep"]


@dataclass(frozen=True)
class WalkStep:
    """Where a walk has come to."""

    number: int
    """of the step, from 0"""
    cycle: int
    """from 1; 0: where the robot is put down"""
    shape: Shape
    """where the robot has walked to"""
    sliding: str
    """what has slid since the step before: 'none', 'rear', 'front' or 'both'"""
    friction_N: float | None
    """with which the feet stretch the body, < 0: press it together; None: target shapes know no forces"""
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


class WalkRun(_Run[WalkStep]):
    """A gait that is walked, step by step. Stop when you like. A step without an equilibrium is the last one."""

    _core: _core.WalkRun

    def __next__(self) -> WalkStep:
        number = self.done
        shape = self._next_shape()
        step: dict[str, Any] = json.loads(self._core.step())
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


class _Walks(_Runs):
    """Of a robot."""

    def walk(
        self,
        gait: Steps,
        *,
        cycles: int = 3,
        times: ArrayLike | None = None,
        store: PathLike | None = None,
        solver: str = "newton",
        tolerance_mm: float | None = None,
        max_iterations: int = DEFAULT_ITERATIONS,
        anderson: int = 6,
        threads: int = 0,
        stable: bool = False,
    ) -> WalkRun:
        """Walks on two feet that slide one way better than the other: an iterator of steps. docs/walking.md

        gait    one cycle of commands as path takes them, (k, m), by name, or a CSV file; its last row is its first
        cycles  how often it is walked, 1 to 100000
        times   (k,) [s], ascending; they go on from cycle to cycle
        store   folder of report.json, walk.csv, walk.svg and walk.pvd with the shapes: a walk that was stopped goes on
                where it was, or with more cycles
        others  as solve's
        raises  InvalidInput where the robot has no feet, or is held or loaded along its way
        """
        if not 1 <= cycles <= 100_000:
            raise ValueError(f"cycles must be a whole number from 1 to 100000, not {cycles}")
        options = _options(solver, tolerance_mm, max_iterations, anderson, threads, stable)
        core = self._steps("gait", gait, times, {})
        return WalkRun(self._owner, _core.WalkRun(self._owner._core, core, cycles, options, _folder(store)))
