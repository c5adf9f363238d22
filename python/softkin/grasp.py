"""Grasps: a gripper closes around a body, and the body is pulled out. docs/contact.md"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import Any

import numpy as np

from . import _core
from ._arrays import Floats, dimensions, vector
from ._compiled import Command, Commands, Compiled
from ._core import InvalidInput
from ._of_robot import Found
from .runs import Steps, steps_of
from .shape import NotConverged, Shape
from .solver import ProgressFunction, progress_callback
from .table import Table

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
    """largest pull with an equilibrium, in addition to the weight and the forces of the scene"""
    moved_mm: float
    """the body's center of mass, from where it was without the pull"""
    normal_N: float
    """sum of the magnitudes of all normal forces on the body, at that force"""
    slipping: float | None
    """fraction of them at slipping contacts [-]; None: no friction, or no contact force"""
    end: str
    """how the pull ended: 'slips', 'gives way' (fails otherwise), 'holds more' (than was tried); else the status"""
    status: str
    """'limit': the largest force was found; 'converged': it holds more; 'not converged', 'interrupted'"""
    shape: Shape
    """the last equilibrium; its `remark` contains details of the failure"""


class Grasp(Found[_core.Grasp]):
    """A gripper that was closed around a body, and the forces that pull the released body out."""

    @property
    def body(self) -> str:
        """Name of the body that is grasped."""
        return self._core.body

    @property
    def held(self) -> bool:
        """Is there an equilibrium at every step of the closing, and one after the body is released?"""
        return self._core.held

    @property
    def reason(self) -> str:
        """Where the body is not held: which step has no equilibrium, and why."""
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

    def __repr__(self) -> str:
        if not self.held:
            return f"<softkin.Grasp of {self.body!r}: {self.reason}>"
        pulls = ", ".join(f"{pull.name} {pull.force_N:.4g} N ({pull.end})" for pull in self.pulls)
        return f"<softkin.Grasp of {self.body!r}: held{'; ' + pulls if pulls else ''}>"

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self)[1:-1])}</p>{self.table._repr_html_()}"


def _direction_text(direction: Direction) -> str:
    if isinstance(direction, str):
        return direction
    return ",".join(repr(x).removesuffix(".0") for x in vector("directions", direction))


def grasped(
    robot: Compiled,
    closing: Steps | Commands | None,
    commands: Mapping[str, Command],
    body: str | None,
    directions: str | Sequence[Direction],
    most_N: float | None,
    options: _core.SolveOptions,
    progress: ProgressFunction | None,
) -> _core.Grasp:
    if most_N is not None and not most_N > 0:
        raise InvalidInput(f"most_N must be a force > 0 in N, not {most_N}")
    texts = [_direction_text(each) for each in ([directions] if isinstance(directions, str) else directions)]
    steps = _closing(robot, closing, commands)
    report = None if progress is None else progress_callback(progress)
    return _core.grasp(robot._core, steps, body or "", texts, most_N, options, report)


def _closing(robot: Compiled, closing: Steps | Commands | None, commands: Mapping[str, Command]) -> _core.Steps:
    """Steps, or one step."""
    given: Any = closing
    is_file = isinstance(given, (str, os.PathLike))
    named = isinstance(given, Sequence) and not is_file and len(given) > 0 and isinstance(given[0], Mapping)
    if given is None or isinstance(given, Mapping) or not (is_file or named or dimensions("closing", given) != 1):
        return steps_of(robot, "closing", [robot._actuation(given, commands)], None, {})
    return steps_of(robot, "closing", given, None, commands)
