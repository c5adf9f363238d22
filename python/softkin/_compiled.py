"""What a robot is made of."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from . import _core, neighbours
from ._arrays import Floats, Indices, floats
from ._core import InvalidInput
from ._description import Entries, add_region, mesh_of, plain
from ._kinds import number_of, shown
from ._warning import warn

if TYPE_CHECKING:
    import meshio
    import pyvista

Command = float | str
Commands = ArrayLike | Mapping[str, Command]
R = TypeVar("R", bound="Compiled")


class Compiled:
    """A robot's elements, actuators and markers, without what is done with it."""

    def __init__(
        self,
        vertices: ArrayLike,
        tetrahedra: ArrayLike | None = None,
        prisms: ArrayLike | None = None,
        *,
        regions: Mapping[str, Any] | None = None,
        materials: Entries,
        fixed: Entries | None = (),
        actuators: Entries | None = (),
        markers: Entries | Mapping[str, Any] | None = (),
        rigid: Sequence[str | Mapping[str, Any]] | None = (),
        void: Sequence[str | Mapping[str, Any]] | None = (),
        gravity: Sequence[float] | None = None,
        forces: Entries | None = (),
        tractions: Entries | None = (),
        fibres: Entries | None = (),
        layers: Entries | None = (),
        submerged: Mapping[str, Any] | None = None,
        sensors: Entries | None = (),
        feet: Entries | None = (),
        contact: Mapping[str, Any] | None = None,
        obstacles: Entries | None = (),
        bodies: Entries | None = (),
        formulation: str | None = None,
        weights: str | None = None,
        units: str = "mm",
        order: int | None = None,
        curve: bool | Mapping[str, Any] | Sequence[Any] | None = None,
        accept_errors: bool = False,
        name: str = "robot",
    ) -> None:
        """A robot of arrays. Descriptions have the keys of a scene: docs/scene.md.

        vertices     (n, 3) [units]
        tetrahedra   (k, 4), or (k, 10) of order 2: corners, then nodes on edges 01, 12, 02, 03, 13, 23
        prisms       (k, 6): bottom triangle, top triangle; membranes of dielectric elastomers
        regions      by name: tetrahedra as indices or as a truth for each; faces (k, 3) of vertices; {"vertices": ...},
                     {"prisms": ...}; or a shape: {"box": ((x, y, z), (x, y, z))}, "sphere", "cylinder", "halfspace"
        markers      entries, or by name: a point, or a region's name
        formulation  'physical' or 'target-shape'; None: physical where a material has elastic constants
        weights      of target shapes: 'printed' (None) or 'mesh-independent'
        units        of every length given here: mm, cm, m, um or in
        order        2: tetrahedra of order 1 get nodes on their edges
        curve        of order 2: True moves the nodes on the surface's edges onto a smooth surface through the vertices;
                     {"cylinder": ...}, {"sphere": ...}, {"file": ...}, {"crease": degrees}, or a list of these
        raises       InvalidInput naming the entry: "actuators[0].range: ..."; ValueError naming an array
        """
        mesh, sizes = mesh_of(vertices, tetrahedra, prisms)
        shapes = [add_region(mesh, sizes, key, value) for key, value in (regions or {}).items()]
        if isinstance(markers, Mapping):
            markers = [
                {"name": key, **({"region": value} if isinstance(value, str) else {"point": value})}
                for key, value in markers.items()
            ]
        description = {
            "softkin": 1,
            "units": {"length": units},
            "mesh": {"order": order, "curve": curve, "accept_errors": accept_errors},
            "formulation": formulation,
            "weights": weights,
            "regions": [shape for shape in shapes if shape is not None],
            "materials": materials,
            "void": void,
            "fixed": fixed,
            "rigid": rigid,
            "actuators": actuators,
            "gravity": gravity,
            "forces": forces,
            "tractions": tractions or None,
            "fibres": fibres or None,
            "layers": layers or None,
            "submerged": submerged,
            "sensors": sensors or None,
            "markers": markers,
            "feet": feet or None,
            "contact": contact,
            "obstacles": obstacles or None,
            "bodies": bodies or None,
        }
        source = _core.Source.of_mesh(name, mesh, plain(description, "description"), "", [])
        self._take(_core.Robot(source, True))

    @classmethod
    def from_meshio(
        cls: type[R], mesh: meshio.Mesh, *, regions: Mapping[str, Any] | None = None, **description: Any
    ) -> R:
        """A robot of a meshio.Mesh; its cell sets, point sets and physical groups are regions.

        description  as of Robot(...)
        """
        return cls(**neighbours.from_meshio(mesh).arguments(regions), **description)

    @classmethod
    def from_pyvista(
        cls: type[R], grid: pyvista.UnstructuredGrid, *, regions: Mapping[str, Any] | None = None, **description: Any
    ) -> R:
        """A robot of a pyvista.UnstructuredGrid; the values of its cell array `region` are regions, named by
        the field data `region_NAME`, else region_0, ...

        description  as of Robot(...)
        """
        return cls(**neighbours.from_pyvista(grid).arguments(regions), **description)

    @classmethod
    def _of(cls: type[R], core: _core.Robot) -> R:
        robot = cls.__new__(cls)
        robot._take(core)
        return robot

    def _take(self, core: _core.Robot) -> None:
        self._core = core
        self._infos = core.actuators
        self._places = {info.name: i for i, info in enumerate(self._infos)}
        self._markers = core.markers
        self._supports = core.supports
        self._rest_actuation: Floats = core.rest_actuation()
        for warning in core.warnings:
            warn(warning)

    def _place(self, name: str) -> int:
        place = self._places.get(name) if isinstance(name, str) else None
        if place is not None:
            return place
        if not isinstance(name, str):
            raise InvalidInput(f"an actuator is named by a text, not by {shown(name)}")
        return self._core.actuator(name)  # raises with the nearest name

    def _actuation(self, given: Commands | None, named: Mapping[str, Command]) -> Floats:
        """Commands in the order of the actuators; those that are not given rest."""
        if given is None:
            values = self._rest_actuation.copy()
        elif isinstance(given, Mapping):
            values = self._actuation(None, given)
        else:
            values = floats("actuation", given, (len(self._places),)).copy()
        if given is not None and named:
            self._refuse_twice(given, named)
        return self._with(values, named)

    def _refuse_twice(self, given: Commands, named: Mapping[str, Command]) -> None:
        """A command is given by one of the two."""
        if not isinstance(given, Mapping):
            self._place(next(iter(named)))
            raise InvalidInput(f"{next(iter(named))} is given twice: an array of commands has one for every actuator")
        for name in named:
            if name in given:
                raise InvalidInput(f"{name} is given twice: among the commands by name and as a keyword")

    def _with(self, values: Floats, named: Mapping[str, Command]) -> Floats:
        """Commands with others in the place of some."""
        places = self._places
        for name, value in named.items():
            place = places.get(name)
            number = value if type(value) is float and math.isfinite(value) else self._number(name, value)
            values[self._place(name) if place is None else place] = number
        return values

    def _number(self, name: str, value: Command) -> float:
        if isinstance(value, str):
            return self._core.parsed("command", name, value)
        self._place(name)
        return number_of(name, value)

    def _blocks(self) -> list[tuple[str, Indices]]:
        """Of elements, named as meshio does: tetrahedra first."""
        blocks = []
        if len(self.edge_nodes):
            blocks.append(("tetra10", np.hstack([self.tetrahedra, self.edge_nodes])))
        elif len(self.tetrahedra):
            blocks.append(("tetra", self.tetrahedra))
        if len(self.prisms):
            blocks.append(("wedge", self.prisms))
        return blocks

    @property
    def name(self) -> str:
        """The file of its scene, or what it was called."""
        return self._core.name

    @property
    def formulation(self) -> str:
        """'physical' or 'target-shape'."""
        return self._core.formulation

    @property
    def fingerprint(self) -> str:
        """16 digits that change with anything that its shapes depend on."""
        return self._core.fingerprint

    @property
    def rest(self) -> Floats:
        """(n, 3) vertices at rest [mm], read-only; those of bodies, then of obstacles are the last ones."""
        return self._core.rest

    @property
    def tetrahedra(self) -> Indices:
        """(k, 4) corners; without void elements, physical: nor those of chambers."""
        return self._core.tetrahedra

    @property
    def edge_nodes(self) -> Indices:
        """(k, 6) nodes on edges 01, 12, 02, 03, 13, 23 of tetrahedra of order 2; else (0, 6)."""
        return self._core.edge_nodes

    @property
    def prisms(self) -> Indices:
        """(k, 6): bottom triangle, top triangle."""
        return self._core.prisms

    @property
    def surface(self) -> Indices:
        """(f, 3) vertices of the triangles of its surface, counterclockwise seen from outside: of the body, walls of
        chambers too, and of sheets without elements. Faces of order 2 are four triangles each. `rest[surface]` and
        `shape.positions[surface]` are the corners [mm]."""
        return self._core.surface

    @property
    def element_regions(self) -> Indices:
        """(e,) per tetrahedron, then prism: place in `region_names`, or -1."""
        return self._core.element_regions

    @property
    def element_materials(self) -> Indices:
        """(e,) per tetrahedron, then prism: place in `materials`, or -1 (part of a chamber)."""
        return self._core.element_materials

    @property
    def region_names(self) -> list[str]:
        return self._core.region_names

    @property
    def materials(self) -> list[str]:
        """The regions of its materials."""
        return self._core.materials

    @property
    def actuators(self) -> list[str]:
        """Names, in the order of every (m,) array of commands."""
        return list(self._places)

    @property
    def actuator_infos(self) -> list[_core.ActuatorInfo]:
        """Kind, control, unit and range of each actuator."""
        return self._infos

    @property
    def markers(self) -> list[str]:
        return list(self._markers)

    @property
    def supports(self) -> list[str]:
        """Names of the entries of `fixed`."""
        return list(self._supports)

    @property
    def rest_actuation(self) -> Floats:
        """(m,) commands where none is given."""
        return self._rest_actuation.copy()

    @property
    def ranges(self) -> Floats:
        """(m, 2) least and greatest command of each actuator."""
        return np.array([info.range for info in self._infos]).reshape(-1, 2)

    @property
    def diagonal_mm(self) -> float:
        """Of the bounding box [mm]."""
        return self._core.diagonal_mm

    @property
    def notes(self) -> list[str]:
        """What was changed when it was compiled, or a user should know."""
        return self._core.notes

    @property
    def warnings(self) -> list[str]:
        """What is probably not meant; each is raised as a SoftkinWarning too."""
        return self._core.warnings

    def __repr__(self) -> str:
        actuators = ", ".join(
            f"{info.name}: {info.control} {info.range[0]:.6g} to {info.command_text(info.range[1])}"
            for info in self._infos
        )
        order = 2 if len(self.edge_nodes) else 1
        elements = f"{len(self.tetrahedra)} tetrahedra of order {order}" if len(self.tetrahedra) else ""
        if len(self.prisms):
            elements += (", " if elements else "") + f"{len(self.prisms)} prisms"
        return (
            f"<softkin.Robot {self.name}: {self._core.robot_vertices} vertices, {elements}; {self.formulation}; "
            f"{actuators or 'no actuator'}; markers {', '.join(self._markers) or 'none'}>"
        )

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(info.name)}</td><td>{info.kind}</td><td>{info.control}</td>"
            f"<td>{info.range[0]:.6g} to {escape(info.command_text(info.range[1]))}</td></tr>"
            for info in self._infos
        )
        return (
            f"<p>{escape(self.name)}: {self._core.robot_vertices} vertices, {len(self.tetrahedra)} tetrahedra, "
            f"{len(self.prisms)} prisms; {self.formulation}; markers {escape(', '.join(self._markers)) or 'none'}</p>"
            f"<table><tr><th>actuator</th><th>kind</th><th>commands</th><th>range</th></tr>{rows}</table>"
        )
