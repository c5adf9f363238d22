"""Inputs, outputs, answers and checks of kinematic maps."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats
from ._core import InvalidInput

__all__ = ["MapAnswer", "MapCheck", "MapEstimate", "MapInput", "MapOutput", "MapProgress", "markers_of"]


class MapProgress(NamedTuple):
    """The progress of a map's construction."""

    equilibria: int
    checks: int
    """solved so far"""
    error: float
    """of the last predictions, over the requested accuracy; inf at first"""
    doing: str
    """'all cables taut', 'tendon2 slack', 'checking'"""


@dataclass(frozen=True)
class MapInput:
    """A command of a map."""

    name: str
    """of the actuator"""
    unit: str
    """'kPa', 'N', 'mT', 'A', 'mm' or 'A m^2'; '' for a ratio to rest [-]"""
    range: tuple[float, float]
    rest: float
    """the value where none is given"""


@dataclass(frozen=True)
class MapOutput:
    """A quantity that a map computes."""

    name: str
    """'tip_x', 'air_pressure', 'tendon1_ratio'"""
    unit: str
    """'mm', 'kPa', 'N' or ''"""
    accuracy: float
    """requested accuracy, in its unit"""
    largest_error: float
    """largest error at the checks, in its unit"""
    mean_error: float

    @property
    def column(self) -> str:
        """Of tables: 'tip_x_mm', 'air_pressure_kPa', 'tendon1_ratio'."""
        return f"{self.name}_{self.unit}" if self.unit else self.name


@dataclass(frozen=True)
class MapCheck:
    """How far a map was from the solver at random actuations that it was not made of. Not a bound."""

    points: int
    """number of compared points"""
    outside: int
    """number of random points that lie outside the map or have no equilibrium"""
    seed: int
    shape_accuracy_mm: float
    """requested accuracy of every vertex; 0: the map has no shape"""
    shape_largest_mm: float
    """of any vertex at any point"""
    shape_mean_mm: float
    """of the farthest vertex, mean over the points"""
    strain_largest: float
    """largest error of the body's minimum and maximum principal strain, computed from the shape"""


@dataclass(frozen=True, eq=False)
class MapAnswer:
    """The outputs of a map for one set of commands, or for N sets, where every array has a row for each set."""

    commands: Floats
    """(i,) or (N, i)"""
    outputs: Floats
    """(q,) or (N, q), in the order of the map's outputs, in their units"""
    inside: NDArray[np.bool_]
    """() or (all,): which of the requested commands are inside the map; those are the N"""
    jacobians: Floats | None
    """(q, i) or (N, q, i) [unit of the output per unit of the command]; None: not requested"""
    of: tuple[MapOutput, ...]
    """the map's outputs"""

    @cached_property
    def _markers(self) -> dict[str, int]:
        return markers_of(self.of)

    def _marker(self, name: str) -> int:
        place = self._markers.get(name)
        if place is None:
            raise InvalidInput(f"the map has no marker {name!r}, but {', '.join(map(repr, self._markers))}")
        return place

    def __getitem__(self, marker: str) -> Floats:
        """(3,) or (N, 3) [mm]"""
        place = self._marker(marker)
        return self.outputs[..., place : place + 3]

    @property
    def markers(self) -> dict[str, Floats]:
        """All of them, by name."""
        return {name: self[name] for name in self._markers}

    @property
    def loads(self) -> dict[str, Floats]:
        """Pressures and tensions by their columns, 'air_pressure_kPa', 'tendon1_tension_N': () or (N,) each."""
        return self._columns("kPa", "N")

    @property
    def ratios(self) -> dict[str, Floats]:
        """Those that actuators achieve, by their columns, 'air_ratio': () or (N,) each [-]."""
        return self._columns("")

    def _columns(self, *units: str) -> dict[str, Floats]:
        return {output.column: self.outputs[..., q][()] for q, output in enumerate(self.of) if output.unit in units}

    def jacobian(self, marker: str | None = None) -> Floats:
        """(3, i) or (N, 3, i) of a marker by the commands [mm per unit]; None: of all outputs, (q, i) or (N, q, i).

        raises  ValueError where solve was called without jacobian=True
        """
        if self.jacobians is None:
            raise InvalidInput("the Jacobian was not requested: solve(..., jacobian=True)")
        if marker is None:
            return self.jacobians
        place = self._marker(marker)
        return self.jacobians[..., place : place + 3, :]

    def __repr__(self) -> str:
        if self.outputs.ndim > 1:
            return f"<softkin.MapAnswer to {len(self.outputs)} of {len(self.inside)} commands>"
        places = "; ".join(f"{name} {', '.join(f'{x:.6g}' for x in at)} mm" for name, at in self.markers.items())
        return f"<softkin.MapAnswer {places}>"


@dataclass(frozen=True, eq=False)
class MapEstimate:
    """Estimates of unmeasured commands, such as forces, from measured outputs of a map."""

    values: dict[str, float]
    """by the names of the inputs, in their units"""
    deviations: dict[str, float]
    """posterior standard deviations"""
    covariance: Floats
    """(u, u) in the order of `values`"""
    answer: MapAnswer
    """the map's outputs at these commands"""
    chi_square: float
    freedoms: float
    """degrees of freedom, the expected value of the chi-square: readings less the unknowns that they determine"""
    misfit: float
    """by how many standard deviations the chi-square is too large; above 3 readings and map do not fit"""
    converged: bool

    def __repr__(self) -> str:
        values = ", ".join(f"{name} {x:.3g} +- {self.deviations[name]:.2g}" for name, x in self.values.items())
        return f"<softkin.MapEstimate {'' if self.converged else 'not converged: '}{values}>"


def markers_of(outputs: tuple[MapOutput, ...]) -> dict[str, int]:
    """Where the x of each marker is."""
    return {output.name[:-2]: q for q, output in enumerate(outputs) if output.unit == "mm" and output.name[-2:] == "_x"}
