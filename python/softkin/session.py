"""Sessions: a robot in a control loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import _core
from ._solving import Solving
from .shape import Shape

if TYPE_CHECKING:
    from .robot import Robot

__all__ = ["Session"]


class Session(Solving):
    """Keeps threads, memory and factors from call to call, and goes on from its last shape. For one thread at a time.

    Results are those of the robot within the tolerance, not bit by bit: a factor that an earlier solve left is used.
    """

    _session: _core.Session

    def __init__(self, robot: Robot) -> None:
        self._owner = robot
        self._session = _core.Session(robot._core)

    @property
    def robot(self) -> Robot:
        return self._owner

    @property
    def shape(self) -> Shape | None:
        """The last equilibrium, from which the next solve goes on; None: rest."""
        return self._last

    def forget(self) -> None:
        """Drops the last shape and the factors: the next result is that of a new session."""
        self._last = self._answer = None
        self._session.forget()

    def __repr__(self) -> str:
        return f"<softkin.Session of {self._owner.name}, at {self._last!r}>"
