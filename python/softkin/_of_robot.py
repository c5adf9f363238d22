"""What is of a robot, and how a report is read."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from . import _core

if TYPE_CHECKING:
    from .robot import Robot

Core = TypeVar("Core")
FoundCore = TypeVar("FoundCore", _core.Shape, _core.Answer, _core.Grasp, _core.Workspace)


def parsed(text: str) -> dict[str, Any]:
    """Of JSON."""
    report: dict[str, Any] = json.loads(text)
    return report


class OfRobot(Generic[Core]):
    """What came of a robot."""

    def __init__(self, robot: Robot, core: Core) -> None:
        self._robot = robot
        self._core = core

    @property
    def robot(self) -> Robot:
        return self._robot


class Found(OfRobot[FoundCore]):
    """The same, which pickles."""

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return _unpickled, (type(self), type(self._core), self._robot, self._core.pickled())


def _unpickled(kind: type[Any], core: type[Any], robot: Robot, state: bytes) -> Any:
    return kind(robot, core.unpickled(robot._core, state))
