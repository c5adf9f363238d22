"""Shapes: equilibria of a robot, and what they measure."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core, neighbours
from ._arrays import Floats
from ._core import Shape as CoreShape
from ._saving import Saving
from .errors import NotConverged

if TYPE_CHECKING:
    import meshio
    import pyvista

    from .robot import Robot

__all__ = ["ActuatorState", "Contact", "Deformation", "MagneticLoad", "Reaction", "SelfOverlap", "Shape", "Views"]


_LOAD_UNITS = {"pneumatic": "kPa", "cable": "N", "dea": "kV"}


@dataclass(frozen=True)
class ActuatorState:
    """An actuator in a shape."""

    name: str
    kind: str
    """'pneumatic', 'cable', 'dea' or 'magnetic'; 'motion', 'force' or 'hold' of what surrounds the robot,
    'turn' of what holds it"""
    requested: float
    """what was commanded, in `unit`"""
    unit: str
    """'kPa', 'N', 'kV', 'mT', 'A', 'mm', 'A m^2' or 'deg'; '' for a ratio to rest [-]"""
    ratio: float
    """volume, length or area over that at rest [-]; of others the command that the shape is of"""
    measure: float
    """volume [mm^3], length [mm] or area [mm^2]; 0 of others"""
    load: float | None
    """gauge pressure [kPa], tension [N] or voltage [kV]; None where the formulation or the kind has none"""
    by_curve: float | None
    """what the actuator's curve asks for: gauge pressure [kPa] or voltage [kV]"""
    slack: bool
    """a cable that carries nothing because its path is shorter than it"""
    charge_nC: float | None = None
    """on the electrodes of a dea under voltage [nC]; else None"""
    capacitance_pF: float | None = None
    """between them [pF]"""
    field_kV_mm: float | None = None
    """the largest true field in its layer [kV/mm]"""
    end_tension_N: float | None = None
    """of a cable that rubs, at its far end [N]; `load` is that at the motor"""
    sticking: float | None = None
    """the share of its friction in which it sticks [-]"""

    def _load_of(self, kind: str, what: str) -> float:
        if self.kind != kind:
            raise AttributeError(f"actuator {self.name!r} is a {self.kind}: it has no {what}")
        if self.load is None:
            why = "its area is controlled" if what == "voltage" else "only the physical formulation knows it"
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
    """What an entry of `fixed` does to the robot; physical formulation."""

    name: str
    force_N: Floats
    """(3,) that the support exerts on the robot [N]"""
    moment_Nmm: Floats
    """(3,) about the centre [N mm]"""
    center_mm: Floats
    """(3,) mean of the vertices that it holds [mm]"""


@dataclass(frozen=True)
class MagneticLoad:
    """What magnetic fields do to the robot."""

    force_N: Floats
    """(3,) [N]"""
    moment_Nmm: Floats
    """(3,) about `center_mm` [N mm]"""
    center_mm: Floats
    """(3,) of the volume of what is magnetic, where it is [mm]"""


@dataclass(frozen=True)
class Contact:
    """What presses on a part of a robot; physical formulation."""

    on: str
    """'robot', or a region that `contact` names"""
    by: str
    """an obstacle, another such part, or the part itself"""
    force_N: Floats
    """(3,) that it exerts [N]; of a part on itself 0"""
    moment_Nmm: Floats
    """(3,) about the centre [N mm]"""
    center_mm: Floats
    """(3,) mean of the places that are pressed, by their normal force [mm]"""
    normal_N: float
    """sum of the magnitudes of all normal forces [N]"""
    pressure_kPa: float
    """the largest on a vertex [kPa]"""
    area_mm2: float
    """[mm^2]"""
    gap_mm: float
    """the least [mm]"""


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


class Views(Mapping[str, Floats]):
    """Markers by name: (3,) arrays [mm]."""

    def __init__(self, names: list[str], core: _core.Shape) -> None:
        self._places = {name: i for i, name in enumerate(names)}
        self._core = core

    def __getitem__(self, name: str) -> Floats:
        place = self._places.get(name)
        if place is None:
            self._core.robot.marker(name)  # raises with the nearest name
            raise KeyError(name)
        return np.array(self._core.marker(place))

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

    def __repr__(self) -> str:
        return "{" + ", ".join(f"{name!r}: {_point(self[name])}" for name in self) + "}"


class Shape(Saving):
    """An equilibrium of a robot, or how far the solver came: see `status`."""

    _core: CoreShape

    def __init__(self, robot: Robot, core: CoreShape) -> None:
        self._robot = robot
        self._core = core

    @property
    def robot(self) -> Robot:
        return self._robot

    @cached_property
    def positions(self) -> Floats:
        """(n, 3) of every vertex [mm], read-only."""
        return self._core.positions

    @property
    def displacements(self) -> Floats:
        """(n, 3) from rest [mm]."""
        return self.positions - self._robot.rest

    def __getitem__(self, marker: str) -> Floats:
        """Where a marker is, (3,) [mm]."""
        return self.markers[marker]

    @cached_property
    def markers(self) -> Views:
        """By name: where they are, (3,) [mm]."""
        return Views(self._robot.markers, self._core)

    @cached_property
    def actuation(self) -> Floats:
        """(m,) what was asked for, in the order of `robot.actuators`: ratio [-], tension [N], pressure [kPa] or
        voltage [kV]."""
        return self._core.actuation

    @cached_property
    def actuators(self) -> dict[str, ActuatorState]:
        """By name: ratio, pressure, tension or voltage."""
        return {
            info.name: ActuatorState(
                *(info.name, info.kind, requested, info.unit, ratio, measure, load, curve, slack),
                *(layer or (None, None, None)),
                *(tendon or (None, None)),
            )
            for info, (requested, ratio, measure, load, curve, slack, layer, tendon) in zip(
                self._robot.actuator_infos, self._core.actuators()
            )
        }

    @property
    def status(self) -> str:
        """'converged', 'not converged', 'interrupted' or 'limit' (no equilibrium can be followed as far as asked)."""
        return self._core.status

    @property
    def converged(self) -> bool:
        return self._core.converged

    @property
    def reached(self) -> float:
        """Share of the way from the start's actuation to the one asked for at which the shape is [-]."""
        return self._core.reached

    @property
    def remark(self) -> str:
        """Why it stopped, where it did not converge; or how it is unstable."""
        return self._core.remark

    @property
    def iterations(self) -> int:
        return self._core.iterations

    @property
    def seconds(self) -> float:
        """Of the solve [s]."""
        return self._core.seconds

    @property
    def unstable_modes(self) -> int:
        """Ways in which the equilibrium is unstable; physical formulation."""
        return self._core.unstable_modes

    @property
    def fingerprint(self) -> str:
        """16 digits that change with any bit of the positions."""
        return self._core.fingerprint

    def require(self) -> Shape:
        """Itself; raises NotConverged where it is no equilibrium of what was asked for."""
        if self.converged:
            return self
        why = f": {self.remark}" if self.remark else ""
        raise NotConverged(f"{self.status} at {100 * self.reached:.4g} % of the way{why}", self)

    @cached_property
    def deformation(self) -> Deformation:
        """Stretches, strains, stresses, inverted elements."""
        core = self._core
        return Deformation(core.volume_ratio, core.strain, core.von_mises, core.principal_stress)

    @cached_property
    def reactions(self) -> dict[str, Reaction]:
        """By the name of the entry of `fixed`; physical formulation, else zero."""
        return {
            name: Reaction(name, np.array(force), np.array(moment), np.array(center))
            for name, (force, moment, center) in zip(self._robot.supports, self._core.reactions)
        }

    @cached_property
    def magnetic_load(self) -> MagneticLoad | None:
        """What magnetic fields do to the robot; None where there is none."""
        load = self._core.magnetic_load
        return None if load is None else MagneticLoad(*(np.array(vector) for vector in load))

    @property
    def vertex_reactions(self) -> Floats:
        """(n, 3) what supports push and pull at the vertices that they hold [N]; physical formulation."""
        return self._core.vertex_reactions

    @cached_property
    def contacts(self) -> list[Contact]:
        """Every pair of parts that touch; physical formulation, with `contact`, `obstacles` or `bodies`."""
        return [
            Contact(on, by, np.array(force), np.array(moment), np.array(center), *measures)
            for on, by, force, moment, center, measures in self._core.contacts
        ]

    @property
    def contact_pressure_kPa(self) -> Floats:
        """(n,) on the vertices [kPa], 0 on obstacles; empty where nothing may touch."""
        return self._core.contact_pressure

    @cached_property
    def self_overlap(self) -> SelfOverlap:
        points, deepest, at = self._core.self_overlap
        return SelfOverlap(points, deepest, np.array(at))

    @cached_property
    def report(self) -> dict[str, Any]:
        """What `softkin fk --report` writes: docs/formats.md."""
        report: dict[str, Any] = json.loads(self._core.report())
        return report

    def to_meshio(self) -> meshio.Mesh:
        """A meshio.Mesh of it, with displacements, strains and stresses; needs meshio."""
        return neighbours.to_meshio(self)

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """A pyvista.UnstructuredGrid of it, with displacements, strains and stresses; needs PyVista."""
        return neighbours.to_pyvista(self)

    def _core_shape(self) -> CoreShape:
        return self._core

    def _title(self) -> str:
        commands = zip(self._robot.actuator_infos, self.actuation)
        title = ", ".join(f"{info.name} = {info.command_text(value)}" for info, value in commands)
        return title if self.converged else f"{title}: {self.status}"

    def _repr_html_(self) -> str:
        rows = [("status", self.status)]
        for state in self.actuators.values():
            load = "" if state.load is None else f", {state.load:.6g} {_LOAD_UNITS[state.kind]}"
            if state.measure == 0:
                rows.append((state.name, f"{state.ratio:.6g} {state.unit or '[-]'}"))
            else:
                rows.append((state.name, f"ratio {state.ratio:.6g} [-]{load}"))
        rows += [(name, f"{_point(place)} mm") for name, place in self.markers.items()]
        cells = "".join(f"<tr><th>{escape(key)}</th><td>{escape(text)}</td></tr>" for key, text in rows)
        return f"<table>{cells}</table>"

    def __repr__(self) -> str:
        commands = zip(self._robot.actuator_infos, self.actuation)
        asked = ", ".join(f"{info.name}={info.command_text(value)}" for info, value in commands)
        places = ", ".join(f"{name} at {_point(place)} mm" for name, place in self.markers.items())
        return f"<softkin.Shape {asked or 'at rest'}: {self.status}{'; ' + places if places else ''}>"

    def __reduce__(self) -> tuple[Callable[[Robot, bytes], Shape], tuple[Robot, bytes]]:
        return _unpickled, (self._robot, self._core.pickled())


def _point(place: Floats) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in place) + ")"


def _unpickled(robot: Robot, state: bytes) -> Shape:
    return Shape(robot, _core.Shape.unpickled(robot._core, state))
