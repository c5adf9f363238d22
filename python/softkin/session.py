"""Sessions: a robot in a control loop."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from . import _core
from ._solving import (
    DEFAULT_ITERATIONS,
    Command,
    Commands,
    ProgressFunction,
    Solving,
    Target,
    _chosen_start,
    _options,
    _within,
)
from .inverse import Answer
from .shape import Shape

if TYPE_CHECKING:
    from .maps import KinematicMap
    from .robot import Robot

__all__ = ["Session"]


class Session(Solving):
    """Keeps threads, memory and factors from call to call, and goes on from its last shape. For one thread at a time.

    Results are those of the robot within the tolerance, not bit by bit: a factor that an earlier solve left is used.
    """

    def __init__(self, robot: Robot) -> None:
        self._owner = robot
        self._session = _core.Session(robot._core)
        self._last: Shape | None = None
        self._answer: Answer | None = None

    @property
    def robot(self) -> Robot:
        return self._owner

    @property
    def shape(self) -> Shape | None:
        """The last equilibrium, from which the next solve goes on; None: rest."""
        return self._last

    def solve(
        self,
        actuation: Commands | None = None,
        /,
        *,
        start: Shape | ArrayLike | str | os.PathLike[str] | None = None,
        map: KinematicMap | None = None,
        polish: bool = False,
        solver: str = "newton",
        tolerance_mm: float | None = None,
        max_iterations: int = DEFAULT_ITERATIONS,
        anderson: int = 6,
        threads: int = 0,
        stable: bool = False,
        beyond: float | None = None,
        as_published: bool = False,
        elapsed_s: float | None = None,
        budget_s: float | None = None,
        progress: ProgressFunction | None = None,
        **commands: Command,
    ) -> Shape:
        """As Robot.solve, from the last equilibrium where no start is given."""
        options = _within(
            _options(solver, tolerance_mm, max_iterations, anderson, threads, stable, elapsed_s, beyond, as_published),
            budget_s,
        )
        by = self._by(map, polish, options)
        found = self._solve(
            self._actuation(actuation, commands), self._last if start is None else start, by, options, progress
        )
        if found.converged:
            self._last, self._answer = found, None
        return found

    def inverse(
        self,
        targets: Mapping[str, Target] | None = None,
        /,
        *,
        planes: Mapping[str, tuple[Sequence[float], Sequence[float]]] | None = None,
        directions: Mapping[tuple[str, str], Sequence[float]] | None = None,
        lever_mm: float | None = None,
        weights: Mapping[str | tuple[str, str], float] | None = None,
        start: Shape | Commands | None = None,
        workspace: str | os.PathLike[str] | None = None,
        prefer: Mapping[str, Command] | None = None,
        fix: Mapping[str, Command] | Sequence[str] | None = None,
        map: KinematicMap | None = None,
        polish: bool = False,
        method: str = "newton",
        tolerance_mm: float | None = None,
        max_equilibria: int = 200,
        descents: int = 30,
        other_starts: int = 3,
        solver: str = "newton",
        step_tolerance_mm: float | None = None,
        max_iterations: int = DEFAULT_ITERATIONS,
        anderson: int = 6,
        threads: int = 0,
        stable: bool = False,
        elapsed_s: float | None = None,
        budget_s: float | None = None,
        progress: ProgressFunction | None = None,
        **markers: Target,
    ) -> Answer:
        """As Robot.inverse, from the last equilibrium, with its derivatives, where no start is given."""
        goals = self._goals({**(targets or {}), **markers}, planes, directions, lever_mm, weights)
        statics = _within(
            _options(solver, step_tolerance_mm, max_iterations, anderson, threads, stable, elapsed_s), budget_s
        )
        options = _core.InverseOptions(method, tolerance_mm, max_equilibria, descents, other_starts, statics)
        start = _chosen_start(goals, start, workspace)
        last = self._answer if start is None else None
        begin = self._last if start is None else start
        by = self._by(map, polish, statics)
        found = self._solve_inverse(goals, begin, last, prefer, fix, by, options, progress)
        if found.shape.converged:
            self._last, self._answer = found.shape, found
        return found

    def forget(self) -> None:
        """Drops the last shape and the factors: the next result is that of a new session."""
        self._last = self._answer = None
        self._session_core.forget()

    @property
    def _session_core(self) -> _core.Session:
        assert self._session is not None
        return self._session

    def __repr__(self) -> str:
        return f"<softkin.Session of {self._owner.name}, at {self._last!r}>"
