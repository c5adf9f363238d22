"""Identification of a robot's parameters from measured poses: docs/poses.md."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from .. import _core
from .._core import InvalidInput
from .._description import changes_of
from .._files import PathLike
from ..robot import Robot, load
from ..table import Table
from .fits import Fit


class RobotFit(Fit[_core.RobotCalibration]):
    """Numbers of a robot, and how they were found from its poses."""

    def __init__(self, core: _core.RobotCalibration, scene: str, changes: Mapping[str, object]) -> None:
        super().__init__(core)
        self._scene = scene
        self._changes = dict(changes)

    @property
    def converged(self) -> bool:
        """Was a minimum found, with an equilibrium in every pose?"""
        return bool(self.report["status"] == "converged")

    @property
    def values(self) -> dict[str, float]:
        """By name, in the scene's units; of base and camera [mm, degrees]."""
        return {number["name"]: number["value"] for number in self.report["numbers"]}

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviation by name; NaN: the poses do not determine it."""
        known = {number["name"]: number["deviation"] for number in self.report["numbers"]}
        return {name: np.nan if deviation is None else deviation for name, deviation in known.items()}

    @property
    def readings(self) -> Table:
        """Measured, computed and their difference, a row each."""
        return Table(self._core.readings)

    def robot(self) -> Robot:
        """The scene's robot with the fitted numbers; base and camera are of the measurements, not of it."""
        own = {name: value for name, value in self.values.items() if name.split(".")[0] not in ("base", "camera")}
        return load(self._scene, changes={**self._changes, **own})


def _fitted_number(name: str, value: float | Sequence[float] | str | None) -> str:
    if value is None:
        return name
    if isinstance(value, str):
        return f"{name}={value}"
    values = value if isinstance(value, Sequence) else [value]
    return f"{name}=" + ",".join(repr(float(each)) for each in values)


def robot(
    scene: PathLike,
    poses: PathLike,
    *,
    fit: Mapping[str, float | Sequence[float] | str | None] | Sequence[str] = (),
    changes: Mapping[str, object] | None = None,
    loss: str = "squares",
    deviation_mm: float | None = None,
    deviation_kPa: float | None = None,
    deviation_N: float | None = None,
    deviation_length_mm: float | None = None,
    deviation_volume_mm3: float | None = None,
    deviation_force_N: float | None = None,
    deviation_angle_deg: float | None = None,
    deviation_direction: float | None = None,
    match_within_mm: float | None = None,
    outlines: PathLike | None = None,
    outline_points: int = 40,
    outline_within_mm: float | None = None,
    given: Mapping[str, float] | None = None,
    keep: int = 0,
    ordered: bool = False,
    threads: int = 0,
    progress: Callable[[int, float], object] | None = None,
) -> RobotFit:
    """Identifies parameters of a robot from its measured poses, by the Levenberg-Marquardt method through equilibria.

    scene      YAML, physical formulation
    poses      CSV: commands as in a path, then tip_x_mm, ... of markers, air_pressure_kPa, tendon_tension_N, or
               air_volume_mm3, tendon_length_mm where loads are commanded, base_force_x_N, ... of supports on the robot;
               dot1_x_mm, ... of dots that are markers nobody named; empty cells were not read
    fit        by path: a start, (start, low, high), "mean+-deviation" (known before) or None, the scene's; or texts as
               of --fit; base.x, base.rx, ...: where the robot stands in the measuring frame [mm, degrees]; camera.x, ...:
               the same, gravity turns along. Empty: the poses are predicted from the scene as it is
    changes    of the scene, by path
    loss       'squares', 'huber' or 'cauchy', which are robust against outliers
    deviation  of a coordinate [mm], pressure [kPa], tension [N], length [mm], volume [mm^3], force [N], angle [deg],
               component of a direction as read; None: by what is left
    match_within_mm   how far a dot without a name may be from the marker that it is [mm]
    outlines   CSV of softkin.measure: outlines of the robot in pictures; the column picture of the poses says of which
               pose each is
    outline_points    to which each outline is thinned, evenly along it; each point counts as a coordinate
    outline_within_mm farther from the robot's outline a point does not count [mm]; None: 5 % of the robot's diagonal
    given      numbers of the measuring frame that are known, such as {"camera.rx": -90} where pictures show x and z
    keep       number of poses, evenly spread, that are left out of the fit and predicted by it
    ordered    for friction or backlash: each pose is solved from the one before, the first from rest;
               otherwise each from rest
    threads    poses side by side; 0: as many as the machine has
    progress   called with the iteration and the root mean square of the markers or outlines [mm], now and then
    raises     InvalidInput naming the file, line and column, or the number
    """
    if loss not in ("squares", "huber", "cauchy"):
        raise InvalidInput(f"loss must be 'squares', 'huber' or 'cauchy', not {loss!r}")
    deviations = {
        "deviation_mm": deviation_mm,
        "deviation_kPa": deviation_kPa,
        "deviation_N": deviation_N,
        "deviation_length_mm": deviation_length_mm,
        "deviation_volume_mm3": deviation_volume_mm3,
        "deviation_force_N": deviation_force_N,
        "deviation_angle_deg": deviation_angle_deg,
        "deviation_direction": deviation_direction,
    }
    for name, deviation in deviations.items():
        if deviation is not None and not deviation > 0:
            raise InvalidInput(f"{name} must be greater than 0, not {deviation}")
    if match_within_mm is not None and not match_within_mm > 0:
        raise InvalidInput(f"match_within_mm must be greater than 0, not {match_within_mm}")
    if outline_points < 1:
        raise InvalidInput(f"outline_points must be at least 1, not {outline_points}")
    if outline_within_mm is not None and not outline_within_mm > 0:
        raise InvalidInput(f"outline_within_mm must be greater than 0, not {outline_within_mm}")
    if keep < 0:
        raise InvalidInput(f"keep must be at least 0, not {keep}")
    task = _core.PosesTask()
    task.scene, task.poses, task.loss = os.fspath(scene), os.fspath(poses), loss
    if isinstance(fit, Mapping):
        task.numbers = [_fitted_number(name, value) for name, value in fit.items()]
    else:
        task.numbers = list(fit)
    task.changes = changes_of(changes)
    task.deviations = [deviation or 0 for deviation in deviations.values()]
    task.match_within_mm = match_within_mm or 0
    task.outlines = "" if outlines is None else os.fspath(outlines)
    task.outline_points = outline_points
    if outline_within_mm is not None:
        task.outline_within_mm = outline_within_mm
    task.given = [f"{name}={float(value)!r}" for name, value in (given or {}).items()]
    task.keep, task.threads, task.ordered = keep, threads, ordered
    return RobotFit(_core.calibrate_robot(task, progress), task.scene, changes or {})
