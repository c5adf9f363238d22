"""Errors and warnings about the given surfaces and options."""

from .._core import InvalidInput
from .._warning import SoftkinWarning

__all__ = ["InvalidInput", "MeshWarning"]


class MeshWarning(SoftkinWarning):
    """A probable mistake: wrong units, large holes, a boundary farther from its surface than the tolerance."""
