"""Shapes: equilibria of a robot, and the quantities that they report."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core, neighbours
from ._arrays import Floats
from ._core import InvalidInput
from ._core import Shape as CoreShape
from ._kinds import nearest, shown
from ._measures import ActuatorState, Contact, Deformation, Fibre, Layer, MagneticLoad, Reaction, SelfOverlap
from ._of_robot import parsed
from ._saving import Saving
from ._warning import warn

if TYPE_CHECKING:
    import meshio
    import pyvista

__all__ = ["ActuatorState", "Contact", "Deformation", "Fibre", "Layer", "MagneticLoad", "NotConverged", "Reaction"]
__all__ += ["SelfOverlap", "Shape", "Views"]

_LOAD_UNITS = {"pneumatic": "kPa", "cable": "N", "dea": "kV"}


class NotConverged(RuntimeError):
    """A shape that was required to be an equilibrium is none. `shape` is the last shape of the solve."""

    def __init__(self, message: str, shape: Shape) -> None:
        super().__init__(message)
        self.shape = shape

    def __reduce__(self) -> tuple[type[NotConverged], tuple[str, Shape]]:
        return type(self), (str(self.args[0]), self.shape)


class UnknownMarker(InvalidInput, KeyError):
    """As a mapping raises it, so that `in` and `get` find out."""

    __str__ = ValueError.__str__


class Views(Mapping[str, Floats]):
    """Markers by name: (3,) arrays [mm]."""

    def __init__(self, names: list[str], core: _core.Shape) -> None:
        self._places = {name: i for i, name in enumerate(names)}
        self._core = core

    def __getitem__(self, name: str) -> Floats:
        place = self._places.get(name)
        if place is None:
            raise UnknownMarker(f"no marker {shown(name)}{nearest(str(name), list(self._places))}")
        return np.array(self._core.marker(place))

    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    def __len__(self) -> int:
        return len(self._places)

    def __repr__(self) -> str:
        return "{" + ", ".join(f"{name!r}: {_point(self[name])}" for name in self) + "}"


class Shape(Saving[CoreShape]):
    """An equilibrium of a robot, or how far the solver came: see `status`."""

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

    def turn(self, marker: str, to: str | None = None) -> float:
        """By how much the line from a marker to another one has turned from rest [degrees]: the bend angle.

        marker   of which the line begins; alone: a marker that is a region or a body, whose own turn it is
        to       the marker at which the line ends
        returns  of a shape of a run it is continued from step to step, as `softkin fk --turn` does, and may be beyond
                 180 or below 0: the first turn is positive; of a shape alone it is 0 to 180
        raises   InvalidInput where there is no such marker, where a single one is a point, which has no orientation, or
                 where both are at one place at rest
        """
        return self._core.turn(marker, to)

    @cached_property
    def actuation(self) -> Floats:
        """(m,) requested commands, in the order of `robot.actuators`: ratio [-], tension [N], pressure [kPa] or
        voltage [kV]."""
        return self._core.actuation

    @cached_property
    def actuators(self) -> dict[str, ActuatorState]:
        """By name: ratio, pressure, tension or voltage."""
        states = {}
        for info, values in zip(self._robot.actuator_infos, self._core.actuators()):
            requested, ratio, measure, load, curve, slack, layer, tendon, (amount, volumes) = values
            charge, capacitance, field = layer or (None, None, None)
            end, sticking = tendon or (None, None)
            states[info.name] = ActuatorState(
                *(info.name, info.kind, requested, info.unit, ratio, measure, load, curve, slack),
                *(charge, capacitance, field, end, sticking, amount, dict(zip(info.connected, volumes)) or None),
            )
        return states

    @property
    def status(self) -> str:
        """'converged', 'not converged', 'interrupted' or 'limit' (the path of equilibria ends before the request)."""
        return self._core.status

    @property
    def converged(self) -> bool:
        return self._core.converged

    @property
    def reached(self) -> float:
        """The load factor: the completed fraction of the change from the start's actuation to the requested one [-]."""
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
        """The number of unstable modes of the equilibrium; physical formulation."""
        return self._core.unstable_modes

    @property
    def fingerprint(self) -> str:
        """16 digits that change with any bit of the positions."""
        return self._core.fingerprint

    def require(self) -> Shape:
        """Returns itself; raises NotConverged where it is no equilibrium of the requested actuation."""
        if self.converged:
            return self
        why = f": {self.remark}" if self.remark else ""
        raise NotConverged(f"{self.status} at {100 * self.reached:.4g} % of the load path{why}", self)

    @cached_property
    def deformation(self) -> Deformation:
        """Stretches, strains, stresses, inverted elements."""
        core = self._core
        return Deformation(core.volume_ratio, core.strain, core.von_mises, core.principal_stress)

    @cached_property
    def reactions(self) -> dict[str, Reaction]:
        """By the name of the entry of `fixed`; physical formulation, else zero."""
        return {
            name: Reaction(
                name,
                np.array(force),
                np.array(moment),
                np.array(center),
                {chamber: np.array(of) for chamber, of, _ in chambers},
                {chamber: np.array(of) for chamber, _, of in chambers},
            )
            for name, (force, moment, center, chambers) in zip(self._robot.supports, self._core.reactions)
        }

    @cached_property
    def magnetic_load(self) -> MagneticLoad | None:
        """What magnetic fields do to the robot; None where there is none."""
        load = self._core.magnetic_load
        return None if load is None else MagneticLoad(*(np.array(vector) for vector in load))

    @cached_property
    def fibres(self) -> dict[str, Fibre]:
        """By name; empty without `fibres` in the scene, and where a map answered."""
        return {
            name: Fibre(name, mean, largest, least, np.array(at), stretch, slack)
            for name, (mean, largest, least), at, stretch, slack in self._core.fibres
        }

    @cached_property
    def layers(self) -> dict[str, Layer]:
        """By name; empty without `layers` in the scene, and where a map answered."""
        return {
            name: Layer(name, largest, least, np.array(at), strain, wrinkled, slack)
            for name, (largest, least), at, (strain, wrinkled, slack) in self._core.layers
        }

    @property
    def vertex_reactions(self) -> Floats:
        """(n, 3) reaction forces of the supports at their vertices [N]; physical formulation."""
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
    def _findings(self) -> list[tuple[int, bool, str]]:
        return self._core.findings()

    @property
    def findings(self) -> list[str]:
        """What `softkin fk` prints about a shape, a line each: strains, stresses, reactions, contacts, warnings."""
        return [text for _, _, text in self._findings]

    @property
    def warnings(self) -> list[str]:
        """Findings that are probably not meant: inverted elements, a shape that passes through itself, an unstable
        equilibrium, ... `solve` and `inverse` of a robot, `path`, `follow` and `walk` raise them as SoftkinWarning."""
        return [_warning_text(text) for _, is_warning, text in self._findings if is_warning]

    @cached_property
    def report(self) -> dict[str, Any]:
        """What `softkin fk --report` writes: docs/formats.md."""
        return parsed(self._core.report())

    def to_meshio(self) -> meshio.Mesh:
        """A meshio.Mesh of it, with the arrays of points and cells that the .vtu of `save` has; needs meshio."""
        return neighbours.to_meshio(*self._content())

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """A pyvista.UnstructuredGrid of it, with the cells and arrays of the .vtu that `save` writes; needs PyVista."""
        return neighbours.to_pyvista(*self._content())

    def _content(self) -> tuple[Floats, neighbours.Blocks, neighbours.Content]:
        """The points, cells and arrays of the .vtu that `save` writes; copies, which outlive the shape."""
        core = self._core.content()
        blocks = self._robot._blocks()
        if len(core.triangles):
            blocks.append(("triangle", core.triangles))
        whole: dict[str, NDArray[Any]] = {name: np.array([value]) for name, value in core.constants}
        for number, name in enumerate(core.region_names):
            whole[f"region_{name}"] = np.array([number], dtype=np.int32)
        cells: dict[str, NDArray[Any]] = {**core.cell_data, "region": core.cell_regions}
        return np.array(self.positions), blocks, neighbours.Content(core.point_data, cells, {**whole, **core.arrays})

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
        texts = ", ".join(f"{info.name}={info.command_text(value)}" for info, value in commands)
        places = ", ".join(f"{name} at {_point(place)} mm" for name, place in self.markers.items())
        return f"<softkin.Shape {texts or 'at rest'}: {self.status}{'; ' + places if places else ''}>"


def _warning_text(line: str) -> str:
    return line.removeprefix("warning: ")


def warn_of(findings: Iterable[tuple[int, bool, str]], raised: set[int] | None = None, where: str = "") -> None:
    """Raises findings that are warnings as SoftkinWarning.

    raised  kinds that were raised before, which are not raised again
    where   before the text: "step 3: "
    """
    for kind, is_warning, text in findings:
        if not is_warning or (raised is not None and kind in raised):
            continue
        if raised is not None:
            raised.add(kind)
        warn(where + _warning_text(text))


def _point(place: Floats) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in place) + ")"
