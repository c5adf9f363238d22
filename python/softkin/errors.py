"""What softkin raises and warns of."""

from ._core import InvalidInput
from ._warning import SoftkinWarning
from .shape import NotConverged

__all__ = ["InvalidInput", "NotConverged", "SoftkinWarning"]
