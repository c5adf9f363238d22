"""Parameters of the model from measurements: docs/calibration.md, docs/poses.md, docs/pressure.md, docs/voltage.md."""

from .curves import Branch, Curve, ModulusCheck, Prediction, dea, pressure
from .materials import Calibration, material, relaxation, tensile
from .poses import RobotFit, robot

__all__ = [
    "Branch",
    "Calibration",
    "Curve",
    "ModulusCheck",
    "Prediction",
    "RobotFit",
    "dea",
    "material",
    "pressure",
    "relaxation",
    "robot",
    "tensile",
]
