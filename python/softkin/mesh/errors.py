"""What can be wrong with what was given."""

from .. import _core

__all__ = ["InvalidInput", "MeshWarning"]

InvalidInput = _core.InvalidInput


class MeshWarning(UserWarning):
    """What is probably not meant: units, large holes, a boundary farther from its surface than asked for."""
