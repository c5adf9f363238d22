"""Estimate external forces, their places and the shape from a few readings. docs/estimate.md"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from . import _core
from ._arrays import Floats
from ._compiled import Command, Commands
from ._core import InvalidInput
from ._kinds import reading_of, shown
from .shape import Shape
from .solver import USUAL, Solver, options_of

if TYPE_CHECKING:
    from .robot import Robot

__all__ = ["Estimate", "Estimator", "PlannedReading", "ToldNumber", "ToldPlace"]

Readings = Mapping[str, float | None]

_KINDS = ("marker_mm", "pressure_kPa", "tension_N", "length_mm", "volume_mm3", "force_N", "angle_deg", "direction")
_PLANNED = ("marker_mm", "length_mm", "volume_mm3", "angle_deg", "direction")


@dataclass(frozen=True)
class ToldNumber:
    """A command or a component of a force, as estimated from readings."""

    name: str
    unit: str
    value: float
    deviation: float
    """standard deviation"""
    known_mean: float
    known_deviation: float
    """prior mean and standard deviation, before the readings"""
    at_bound: int
    """-1, 1: at the low or high end of its range; else 0"""


@dataclass(frozen=True)
class ToldPlace:
    """Where a force was estimated to act."""

    force: str
    at_rest: Floats
    """(3,) on the robot at rest [mm]"""
    present: Floats
    """(3,) now [mm]"""
    covariance: Floats
    """(3, 3) of at_rest, in the surface [mm^2]"""


@dataclass(frozen=True)
class PlannedReading:
    """A further reading with the largest information gain, given the readings before it."""

    name: str
    vertex: int | None
    """vertex at which a further marker is to be placed; None: a marker, a sensor or a measure of the scene"""
    at_rest: Floats | None
    """(3,) of a marker [mm]"""
    bits: float
    """information about all unknowns"""
    numbers: dict[str, float]
    """remaining standard deviations, by the names of commands, in their units"""
    places: dict[str, float]
    """the same of places, by the names of forces, root of the trace of the covariance [mm]"""


class Estimate:
    """The unknowns and the shape that were estimated from readings."""

    def __init__(self, robot: Robot, core: _core.Told) -> None:
        self._robot = robot
        self._core = core

    @property
    def converged(self) -> bool:
        return self._core.status == "converged"

    @property
    def status(self) -> str:
        """'converged', 'not converged' or 'interrupted'."""
        return self._core.status

    @property
    def remark(self) -> str:
        """Why it is not converged."""
        return self._core.remark

    @cached_property
    def numbers(self) -> dict[str, ToldNumber]:
        """By the names of their commands: touch_fx, air, ..."""
        fields = ("name", "unit", "value", "deviation", "known_mean", "known_deviation", "at_bound")
        return {n.name: ToldNumber(*(getattr(n, field) for field in fields)) for n in self._core.numbers}

    @cached_property
    def places(self) -> dict[str, ToldPlace]:
        """By the names of their forces."""
        return {p.force: ToldPlace(p.force, p.at_rest, p.present, p.covariance) for p in self._core.places}

    @cached_property
    def covariance(self) -> Floats:
        """Of the numbers in their order, then two tangents of each place [mm]."""
        return self._core.covariance

    @property
    def computed(self) -> Floats:
        """The readings as the estimate has them, in the order of `Estimator.readings`."""
        return self._core.computed

    @property
    def chi_square(self) -> float:
        return self._core.chi_square

    @property
    def freedoms(self) -> float:
        """Degrees of freedom, the expected value of the chi-square: readings less the unknowns that they determine."""
        return self._core.freedoms

    @property
    def misfit(self) -> float:
        """By how many standard deviations the chi-square is too large."""
        return self._core.misfit

    @property
    def left_out(self) -> list[str]:
        """Readings that contradict the others."""
        return self._core.left_out

    @property
    def words(self) -> list[str]:
        """Unknowns that the readings hardly determine, and whether the readings fit the model."""
        return self._core.words

    @property
    def seconds(self) -> float:
        return self._core.seconds

    @property
    def equilibria(self) -> int:
        """How many were solved for it."""
        return self._core.equilibria

    @cached_property
    def shape(self) -> Shape | None:
        """The whole shape; None: none was found."""
        return None if self._core.shape is None else Shape(self._robot, self._core.shape)

    @cached_property
    def vertex_deviations(self) -> Floats:
        """(n, 3) standard deviations of the vertices along each axis [mm]."""
        return self._core.vertex_deviations(len(self._robot.rest))

    def __repr__(self) -> str:
        numbers = ", ".join(f"{n.name} {n.value:.3g} +- {n.deviation:.2g} {n.unit}" for n in self.numbers.values())
        return f"<softkin.Estimate {self.status}: {numbers}>"


class Estimator:
    """Estimates unknowns from readings; each update starts from the last estimate. For one thread at a time."""

    def __init__(
        self,
        robot: Robot,
        unknowns: str | Sequence[str],
        deviations: Mapping[str, float],
        *,
        fade_s: float = 0,
        leave_out: bool = True,
        solver: Solver | str = USUAL,
    ) -> None:
        if not (fade_s >= 0 and math.isfinite(fade_s)):
            raise InvalidInput(f"fade_s must be a time of 0 s or more, not {fade_s}")
        self._robot = robot
        self._fades = fade_s > 0
        self._last: float | None = None
        self.readings = tuple(deviations)
        """columns of the readings, in their order"""
        names = [unknowns] if isinstance(unknowns, str) else list(unknowns)
        values = np.array([float(value) for value in deviations.values()], dtype=np.float64)
        self._core = _core.Estimator(
            robot._core, names, list(self.readings), values, float(fade_s), leave_out, options_of(solver)
        )

    @property
    def robot(self) -> Robot:
        return self._robot

    @property
    def told_commands(self) -> list[str]:
        """Commands that are estimated and therefore need no value."""
        return self._core.told_commands

    def update(
        self,
        readings: Readings,
        actuation: Commands | None = None,
        /,
        *,
        time_s: float | None = None,
        **commands: Command,
    ) -> Estimate:
        """Estimates the unknowns from readings.

        readings   by their columns; those that are left out, None or NaN were not read
        actuation  measured commands, as solve's
        time_s     when it was read [s], not before the last time; None: now. Read where estimates fade
        """
        if not isinstance(readings, Mapping):
            raise InvalidInput(f"readings must be a dictionary, not {shown(readings)}")
        unknown = set(readings) - set(self.readings)
        if unknown:
            raise InvalidInput(f"no deviation is known of {sorted(map(str, unknown))}; readings are {list(self.readings)}")
        requested = self._robot._actuation(actuation, commands)
        values = np.array([reading_of(name, readings.get(name)) for name in self.readings], dtype=np.float64)
        elapsed = self._elapsed(time_s) if self._fades else 0.0
        return Estimate(self._robot, self._core.update(requested, values, elapsed))

    def plan(
        self, estimates: Estimate | Sequence[Estimate], deviations: Mapping[str, float], count: int = 3
    ) -> list[PlannedReading]:
        """Plans the further readings with the most information, one by one: D-optimal, to first order at the estimates.

        estimates   of this estimator, over which information is averaged
        deviations  of what may be read: marker_mm (of further markers on the surface, too), length_mm, volume_mm3,
                    angle_deg, direction; a kind that is left out is not considered
        count       1 or more; the plan is shorter where further readings would add no information
        """
        unknown = set(deviations) - set(_PLANNED)
        if unknown:
            raise InvalidInput(f"a plan is of {list(_PLANNED)}, not of {sorted(unknown)}")
        if any(not (value > 0 and math.isfinite(value)) for value in deviations.values()):
            raise InvalidInput("deviations must be above 0")
        given = [estimates] if isinstance(estimates, Estimate) else list(estimates)
        values = np.array([float(deviations.get(kind, 0)) for kind in _KINDS], dtype=np.float64)
        numbers = [name for each in given[:1] for name in each.numbers]
        places = [name for each in given[:1] for name in each.places]
        return [
            PlannedReading(
                p.name,
                p.vertex if p.vertex >= 0 else None,
                p.at_rest if p.vertex >= 0 or p.name.startswith("marker") else None,
                p.bits,
                dict(zip(numbers, map(float, p.numbers))),
                dict(zip(places, map(float, p.places))),
            )
            for p in self._core.plan([each._core for each in given], values, int(count))
        ]

    def _elapsed(self, time_s: float | None) -> float:
        now = time.monotonic() if time_s is None else float(time_s)
        elapsed = 0.0 if self._last is None else now - self._last
        if not elapsed >= 0:
            raise InvalidInput(f"time_s must not go back: {now} s is {-elapsed:.3g} s before the last readings")
        self._last = now
        return elapsed

    def forget(self) -> None:
        """Drops the last estimate: the next one is searched for."""
        self._last = None
        self._core.forget()

    def __repr__(self) -> str:
        return f"<softkin.Estimator of {self._robot.name}: {', '.join(self.told_commands)}>"
