"""What softkin warns of."""

from __future__ import annotations

import sys
import warnings


class SoftkinWarning(UserWarning):
    """What is probably not meant: units, elements that lock."""


def warn(message: str, kind: type[Warning] = SoftkinWarning) -> None:
    """As from the line that called this package."""
    level = 1
    while sys._getframe(level).f_globals.get("__name__", "").partition(".")[0] == "softkin":
        level += 1
    warnings.warn(message, kind, stacklevel=level + 1)
