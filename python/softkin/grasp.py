"""Grasps: a gripper closes around a body, and the body is pulled out. docs/contact.md"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._arrays import Floats, vector
from ._solving import DEFAULT_ITERATIONS, Command, Commands, ProgressFunction, _options, _telling
from .errors import NotConverged
from .runs import Steps, _Runs
from .shape import Shape
from .table import Table

if TYPE_CHECKING:
    from .robot import Robot

__all__ = ["Grasp", "Pull"]

Direction = str | Sequence[float] | Floats
AXES = ("x", "-x", "y", "-y", "z", "-z")


@dataclass(frozen=True)
class Pull:
    """How far a body could be pulled along a direction."""

    name: str
    """of the direction, as it was given: 'x', '1,0,-1'"""
    direction: Floats
    """(3,) of length 1"""
    force_N: float
    """the largest at which there is an equilibrium; besides weight and what the scene pushes with"""
    moved_mm: float
    """the body's center of mass, from where it was without the pull"""
    normal_N: float
    """sum of the magnitudes of all normal forces on the body, at that force"""
    slipping: float | None
    """share of them where it slips [-]; None: no friction, or nothing presses"""
    end: str
    """what gave way: 'slips', 'gives way' (otherwise), 'holds more' (than was tried); else the status"""
    status: str
    """'limit': the largest force was found; 'converged': it holds more; 'not converged', 'interrupted'"""
    shape: Shape
    """the last equilibrium; its `remark` says more about what gave way"""


class Grasp:
    """A gripper that was closed around a body and has let go of it, and what it took to pull the body out."""

    def __init__(self, robot: Robot, core: _core.Grasp) -> None:
        self._robot = robot
        self._core = core

    @property
    def robot(self) -> Robot:
        return self._robot

    @property
    def body(self) -> str:
        """Name of the body that is grasped."""
        return self._core.body

    @property
    def held(self) -> bool:
        """Was there an equilibrium at every step of the closing, and one without what held the body?"""
        return self._core.held

    @property
    def reason(self) -> str:
        """What has no equilibrium and why, where not held."""
        return self._core.remark

    @cached_property
    def shape(self) -> Shape:
        """The grasp before the body is pulled; where not held, how far the solver came."""
        return Shape(self._robot, self._core.shape)

    @cached_property
    def pulls(self) -> list[Pull]:
        """One for each direction, in their order; none where not held. One that was interrupted is the last."""
        return [
            Pull(name, np.array(along), force, moved, normal, slipping, end, status, Shape(self._robot, shape))
            for name, along, (force, moved, normal), slipping, end, status, shape in self._core.pulls()
        ]

    @property
    def table(self) -> Table:
        """The pulls: what `softkin grasp --table` writes."""
        return Table(self._core.table())

    def require(self) -> Grasp:
        """Itself; raises NotConverged where the body is not held, or a pull was lost or interrupted."""
        if not self.held:
            raise NotConverged(self.reason, self.shape)
        for pull in self.pulls:
            if pull.status not in ("limit", "converged"):
                why = f": {pull.shape.remark}" if pull.shape.remark else ""
                raise NotConverged(f"pulling along {pull.name}: {pull.status}{why}", pull.shape)
        return self

    def __reduce__(self) -> tuple[Callable[[Robot, bytes], Grasp], tuple[Robot, bytes]]:
        return _unpickled, (self._robot, self._core.pickled())

    def __repr__(self) -> str:
        if not self.held:
            return f"<softkin.Grasp of {self.body!r}: {self.reason}>"
        pulls = ", ".join(f"{pull.name} {pull.force_N:.4g} N ({pull.end})" for pull in self.pulls)
        return f"<softkin.Grasp of {self.body!r}: held{'; ' + pulls if pulls else ''}>"

    def _repr_html_(self) -> str:
        from html import escape

        return f"<p>{escape(repr(self)[1:-1])}</p>{self.table._repr_html_()}"


def _unpickled(robot: Robot, state: bytes) -> Grasp:
    return Grasp(robot, _core.Grasp.unpickled(robot._core, state))


def _direction_text(direction: Direction) -> str:
    if isinstance(direction, str):
        return direction
    return ",".join(repr(x).removesuffix(".0") for x in vector("directions", direction))


class _Grasps(_Runs):
    """Of a robot."""

    def grasp(
        self,
        closing: Steps | Commands | None = None,
        /,
        *,
        body: str | None = None,
        directions: str | Sequence[Direction] = AXES,
        most_N: float | None = None,
        solver: str = "newton",
        tolerance_mm: float | None = None,
        max_iterations: int = DEFAULT_ITERATIONS,
        anderson: int = 6,
        threads: int = 0,
        stable: bool = False,
        progress: ProgressFunction | None = None,
        **commands: Command,
    ) -> Grasp:
        """Closes a gripper with the scene's bodies held, releases one, and pulls it until it slips. docs/contact.md

        closing     commands as `solve` takes them, (m,) or by name; or steps as `path` takes them, (k, m), by name for
                    each step, or a CSV file
        body        which one is released and pulled; None: the only one
        directions  of the pulls: 'x', '-x', 'y', '-y', 'z', '-z', or (x, y, z) of any length
        most_N      no larger pull is tried [N]
        progress    as solve's, of each solve; False ends the grasp with what there is
        commands    of actuators that closing does not name
        others      as solve's
        returns     not being held is its `held`, not converging the status of a pull
        raises      InvalidInput where there is no such body
        """
        robot = self._owner
        options = _options(solver, tolerance_mm, max_iterations, anderson, threads, stable)
        if most_N is not None and not most_N > 0:
            raise ValueError(f"most_N must be a force > 0 in N, not {most_N}")
        asked = [directions] if isinstance(directions, str) else directions
        core = _core.grasp(
            robot._core,
            self._closing(closing, commands),
            body or "",
            [_direction_text(direction) for direction in asked],
            most_N,
            options,
            None if progress is None else _telling(progress),
        )
        return Grasp(robot, core)

    def _closing(self, closing: Steps | Commands | None, commands: Mapping[str, Command]) -> _core.Steps:
        """Steps, or one step."""
        given: Any = closing
        is_file = isinstance(given, (str, os.PathLike))
        named = isinstance(given, Sequence) and not is_file and len(given) > 0 and isinstance(given[0], Mapping)
        if given is None or isinstance(given, Mapping) or not (is_file or named or np.ndim(given) != 1):
            return self._steps("closing", [self._actuation(given, commands)], None, {})
        return self._steps("closing", given, None, commands)
