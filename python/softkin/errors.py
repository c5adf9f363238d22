"""What softkin raises and warns of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._core import InvalidInput

if TYPE_CHECKING:
    from .shape import Shape

__all__ = ["InvalidInput", "NotConverged", "SoftkinWarning"]


class NotConverged(RuntimeError):
    """A shape that was required to be an equilibrium is none. `shape` is what there is."""

    def __init__(self, message: str, shape: Shape) -> None:
        super().__init__(message)
        self.shape = shape

    def __reduce__(self) -> tuple[type[NotConverged], tuple[str, Shape]]:
        return type(self), (str(self.args[0]), self.shape)


class SoftkinWarning(UserWarning):
    """What is probably not meant: units, elements that lock."""
