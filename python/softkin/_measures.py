"""Quantities that shapes report."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ._arrays import Floats


@dataclass(frozen=True)
class ActuatorState:
    """An actuator in a shape."""

    name: str
    kind: str
    """'pneumatic', 'cable', 'dea', 'magnetic' or 'growth'; of surroundings 'motion', 'force' or 'hold';
    'turn' of a support"""
    requested: float
    """the command, in `unit`"""
    unit: str
    """'kPa', 'N', 'kV', 'mL', 'mT', 'A', 'mm', 'A m^2', 'deg' or 'degC'; '' for a ratio to rest [-]"""
    ratio: float
    """volume, length or area over that at rest [-]; of others the command that the shape is of"""
    measure: float
    """volume [mm^3], length [mm] or area [mm^2]; 0 of others"""
    load: float | None
    """gauge pressure [kPa], tension [N] or voltage [kV]; None where the formulation or the kind has none"""
    by_curve: float | None
    """the load that the actuator's curve predicts: gauge pressure [kPa] or voltage [kV]"""
    slack: bool
    """a cable without tension, because its path is shorter than the cable"""
    charge_nC: float | None = None
    """on the electrodes of a dea under voltage [nC]; else None"""
    capacitance_pF: float | None = None
    """between them [pF]"""
    field_kV_mm: float | None = None
    """the largest true field in its layer [kV/mm]"""
    end_tension_N: float | None = None
    """tension of a cable with friction at its far end [N]; `load` is the tension at the motor"""
    sticking: float | None = None
    """fraction of its friction in the sticking state [-]"""
    amount_mL: float | None = None
    """of a sealed chamber: its gas or liquid, that in its syringe and dead volume with it [mL under atmospheric
    pressure]; else None"""
    volumes_mL: dict[str, float] | None = None
    """of chambers that are connected: the volume of each by its region [mL]; else None"""

    def _load_of(self, kind: str, what: str) -> float:
        if self.kind != kind:
            raise AttributeError(f"actuator {self.name!r} is a {self.kind}: it has no {what}")
        if self.load is None:
            why = "its area is controlled" if what == "voltage" else "only the physical formulation computes it"
            raise AttributeError(f"actuator {self.name!r} has no {what}: {why}")
        return self.load

    @property
    def pressure_kPa(self) -> float:
        """Gauge pressure in the chamber [kPa]; physical formulation."""
        return self._load_of("pneumatic", "pressure")

    @property
    def tension_N(self) -> float:
        """Tension of the cable [N]; physical formulation."""
        return self._load_of("cable", "tension")

    @property
    def voltage_kV(self) -> float:
        """Voltage of the dea [kV]; physical formulation, `control: voltage`."""
        return self._load_of("dea", "voltage")

    @property
    def volume_mm3(self) -> float:
        """Volume of the chamber [mm^3]."""
        self._is("pneumatic", "volume")
        return self.measure

    @property
    def length_mm(self) -> float:
        """Length of the cable's path [mm]."""
        self._is("cable", "length")
        return self.measure

    @property
    def area_mm2(self) -> float:
        """Mean area of the membrane [mm^2]."""
        self._is("dea", "area")
        return self.measure

    def _is(self, kind: str, what: str) -> None:
        if self.kind != kind:
            raise AttributeError(f"actuator {self.name!r} is a {self.kind}: it has no {what}")


@dataclass(frozen=True)
class Reaction:
    """The force and moment that an entry of `fixed` exerts on the robot; physical formulation."""

    name: str
    force_N: Floats
    """(3,) that the support exerts on the robot [N]"""
    moment_Nmm: Floats
    """(3,) about the centre [N mm]"""
    center_mm: Floats
    """(3,) mean of the vertices that it holds [mm]"""
    air_force_N: dict[str, Floats] = field(default_factory=dict)
    """(3,) by actuator, of each chamber that the support closes: force of its pressure on the support [N], which is no
    part of `force_N`"""
    air_moment_Nmm: dict[str, Floats] = field(default_factory=dict)
    """(3,) the same, moment about the centre [N mm]"""


@dataclass(frozen=True)
class MagneticLoad:
    """The force and moment that magnetic fields exert on the robot."""

    force_N: Floats
    """(3,) [N]"""
    moment_Nmm: Floats
    """(3,) about `center_mm` [N mm]"""
    center_mm: Floats
    """(3,) centroid of the magnetic volume in the deformed shape [mm]"""


@dataclass(frozen=True)
class Fibre:
    """The tension in an embedded fibre."""

    name: str
    mean_N: float
    """mean tension along the fibre [N]; below 0: compression"""
    largest_N: float
    """largest tension [N], at `at_mm`"""
    least_N: float
    """smallest tension [N]"""
    at_mm: Floats
    """(3,) where the tension is largest [mm]"""
    stretch: float
    """length over that at rest [-]"""
    slack: float
    """fraction of its length without tension [-]"""


@dataclass(frozen=True)
class Layer:
    """The tension in an elastic sheet."""

    name: str
    largest_N_mm: float
    """largest principal tension per width [N/mm], at `at_mm`"""
    least_N_mm: float
    """smallest principal tension per width [N/mm]; below 0: compression"""
    at_mm: Floats
    """(3,) where the tension is largest [mm]"""
    strain: float
    """largest principal stretch minus 1 [-]"""
    wrinkled: float
    """fraction of its area that is in tension along one direction only [-]"""
    slack: float
    """fraction of its area without tension [-]"""


@dataclass(frozen=True)
class Contact:
    """The contact between two parts; physical formulation."""

    on: str
    """'robot', or a region that `contact` names"""
    by: str
    """an obstacle, another such part, or the part itself"""
    force_N: Floats
    """(3,) contact force of `by` on `on` [N]; 0 where a part touches itself"""
    moment_Nmm: Floats
    """(3,) about the centre [N mm]"""
    center_mm: Floats
    """(3,) mean of the contact points, weighted by their normal forces [mm]"""
    normal_N: float
    """sum of the magnitudes of all normal forces [N]"""
    pressure_kPa: float
    """largest contact pressure at a vertex [kPa]"""
    area_mm2: float
    """[mm^2]"""
    gap_mm: float
    """smallest gap [mm]"""


@dataclass(frozen=True)
class SelfOverlap:
    """How far a shape passes through itself."""

    points: int
    """of its surface that lie inside it; 0: none"""
    deepest_mm: float
    at_mm: Floats
    """(3,) where the deepest one is [mm]"""


@dataclass(frozen=True)
class Deformation:
    """Per element, tetrahedra first, then prisms."""

    volume_ratio: Floats
    """(e,) det F [-]; <= 0: inverted"""
    strain: Floats
    """(e, 3) principal stretches minus 1, descending [-]"""
    von_mises_MPa: Floats
    """(e,) physical formulation; else empty"""
    principal_stress_MPa: Floats
    """(e, 3) descending, tension positive; physical formulation; else empty"""

    @property
    def stretches(self) -> Floats:
        """(e, 3) principal stretches, descending [-]."""
        return self.strain + 1

    @property
    def inverted(self) -> NDArray[np.bool_]:
        """(e,) elements that are turned inside out."""
        return self.volume_ratio <= 0
