"""softkin: kinematics of soft robots.

Lengths are in mm, pressures in kPa (gauge), forces in N, ratios without unit. docs/python.md
"""

import sys as _sys

from . import calibrate, compare, drive, measure
from ._build import BuildInfo, build_info
from ._checks import guard as _guard
from ._core import ActuatorInfo
from ._core import version as __version__
from ._solving import Sensitivity
from .errors import InvalidInput, NotConverged, SoftkinWarning
from .estimate import Estimate, Estimator, PlannedReading, ToldNumber, ToldPlace
from .examples import example
from .grasp import Grasp, Pull
from .inverse import Answer
from .map_answer import MapAnswer, MapCheck, MapEstimate, MapInput, MapOutput, MapProgress
from .maps import KinematicMap, load_map
from .page import PageView
from .robot import Robot, load
from .runs import FollowRun, PathRun, Waypoint
from .session import Session
from .shape import ActuatorState, Contact, Deformation, Fibre, Layer, MagneticLoad, Reaction, SelfOverlap, Shape
from .solver import Progress, Solver
from .table import Table
from .walk import WalkRun, WalkStep
from .workspace import Hull, Workspace

__all__ = [
    "ActuatorInfo",
    "ActuatorState",
    "Answer",
    "BuildInfo",
    "Contact",
    "Deformation",
    "Estimate",
    "Estimator",
    "Fibre",
    "FollowRun",
    "Grasp",
    "Hull",
    "InvalidInput",
    "KinematicMap",
    "Layer",
    "MagneticLoad",
    "MapAnswer",
    "MapCheck",
    "MapEstimate",
    "MapInput",
    "MapOutput",
    "MapProgress",
    "NotConverged",
    "PageView",
    "PathRun",
    "PlannedReading",
    "Progress",
    "Pull",
    "Reaction",
    "Robot",
    "SelfOverlap",
    "Sensitivity",
    "Session",
    "Shape",
    "SoftkinWarning",
    "Solver",
    "Table",
    "ToldNumber",
    "ToldPlace",
    "WalkRun",
    "WalkStep",
    "Waypoint",
    "Workspace",
    "__version__",
    "build_info",
    "calibrate",
    "compare",
    "drive",
    "example",
    "load",
    "load_map",
    "measure",
]

_guard(__all__, _sys.modules[__name__], constructed=("Estimator", "Robot", "Session", "Solver"))
for _module, _made in ((calibrate, ()), (compare, ()), (drive, ("Marlin",)), (measure, ("Board",))):
    _guard(_module.__all__, _module, constructed=_made)
