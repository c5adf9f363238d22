"""What can be wrong with what was given."""

from .._core import InvalidInput
from .._warning import SoftkinWarning

__all__ = ["InvalidInput", "MeshWarning"]


class MeshWarning(SoftkinWarning):
    """What is probably not meant: units, large holes, a boundary farther from its surface than asked for."""
