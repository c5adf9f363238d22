"""Robots: made of a scene, or of arrays in memory."""

from __future__ import annotations

import hashlib
import os
import warnings
import weakref
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _core, neighbours
from ._arrays import Floats, Indices, floats, indices, vector
from ._solving import Command
from .errors import SoftkinWarning
from .grasp import Grasp, _Grasps
from .maps import KinematicMap, _Maps
from .page import _Pages
from .runs import FollowRun, PathRun
from .walk import WalkRun, _Walks
from .workspace import _Workspaces

if TYPE_CHECKING:
    import meshio
    import pyvista

    from .session import Session

__all__ = ["Robot", "load"]

Forces = Mapping[str, Sequence[float]]
Entries = Sequence[Mapping[str, Any]]

_unpickled_robots: weakref.WeakValueDictionary[bytes, Robot] = weakref.WeakValueDictionary()


def _plain(value: Any, path: str) -> Any:
    """Dicts, lists, words and numbers, as a scene has them; entries that are None are left out."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item, f"{path}.{key}") for key, item in value.items() if item is not None}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist(), path)
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, Sequence):
        return [_plain(item, f"{path}[{i}]") for i, item in enumerate(value)]
    raise TypeError(f"{path} must be of dicts, lists, words and numbers, not {type(value).__name__}")


def _force_texts(forces: Forces | None) -> list[str]:
    if not forces:
        return []
    return [f"{name}=" + ",".join(repr(x) for x in vector(f"forces: {name}", force)) for name, force in forces.items()]


def _yaml_text(value: object) -> str:
    """A number, a word or a list of them as a scene has it."""
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_yaml_text(each) for each in value) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return value if isinstance(value, str) else repr(float(value))  # type: ignore[arg-type]


def _formulation(name: str | None) -> str:
    if name not in (None, "physical", "target-shape"):
        raise ValueError(f"formulation must be 'physical' or 'target-shape', not {name!r}")
    return name or ""


def _mesh(vertices: ArrayLike, tetrahedra: ArrayLike | None, prisms: ArrayLike | None) -> tuple[_core.Mesh, list[int]]:
    """And how many vertices, tetrahedra and prisms it has."""
    points = floats("vertices", vertices, (None, 3))
    many = len(points)
    nodes = 10 if tetrahedra is not None and np.ndim(tetrahedra) == 2 and np.shape(tetrahedra)[1] == 10 else 4
    tets = indices("tetrahedra", () if tetrahedra is None else tetrahedra, (None, nodes), many, "vertices")
    wedges = indices("prisms", () if prisms is None else prisms, (None, 6), many, "vertices")
    return _core.Mesh(points, tets, wedges), [many, len(tets), len(wedges)]


def _add_region(mesh: _core.Mesh, sizes: list[int], name: str, value: Any) -> dict[str, Any] | None:
    """Puts a region into the mesh; or returns its entry of the description, where it is a shape."""
    vertices, tets, prisms = sizes
    none = np.zeros(0, np.int32)
    what = f"regions: {name}"
    if isinstance(value, Mapping):
        keys = set(value)
        if keys and keys <= {"tetrahedra", "prisms"}:
            of_tets = indices(what, value.get("tetrahedra", ()), (None,), tets, "tetrahedra")
            of_prisms = indices(what, value.get("prisms", ()), (None,), prisms, "prisms")
            mesh.add_volume(name, of_tets, of_prisms)
        elif keys == {"triangles"}:
            mesh.add_faces(name, indices(what, value["triangles"], (None, 3), vertices, "vertices"))
        elif keys == {"vertices"}:
            mesh.add_vertices(name, indices(what, value["vertices"], (None,), vertices, "vertices"))
        else:
            return {"name": name, **value}
    elif np.ndim(value) == 2:
        mesh.add_faces(name, indices(what, value, (None, 3), vertices, "vertices"))
    else:
        array = np.asarray(value)
        if array.dtype == bool:
            if array.shape != (tets,):
                raise ValueError(f"{what} must have shape ({tets},), a truth per tetrahedron, not {array.shape}")
            array = np.flatnonzero(array)
        mesh.add_volume(name, indices(what, array, (None,), tets, "tetrahedra"), none)
    return None


class Robot(_Walks, _Grasps, _Workspaces, _Maps, _Pages):
    """A compiled robot; immutable. Every solve stands for itself, so that threads may share it."""

    def __init__(
        self,
        vertices: ArrayLike,
        tetrahedra: ArrayLike | None = None,
        prisms: ArrayLike | None = None,
        *,
        regions: Mapping[str, Any] | None = None,
        materials: Entries,
        fixed: Entries = (),
        actuators: Entries = (),
        markers: Entries | Mapping[str, Any] = (),
        rigid: Sequence[str | Mapping[str, Any]] = (),
        void: Sequence[str] = (),
        gravity: Sequence[float] | None = None,
        forces: Entries = (),
        feet: Entries = (),
        contact: Mapping[str, Any] | None = None,
        obstacles: Entries = (),
        bodies: Entries = (),
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
        mesh, sizes = _mesh(vertices, tetrahedra, prisms)
        shapes = [_add_region(mesh, sizes, key, value) for key, value in (regions or {}).items()]
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
            "markers": markers,
            "feet": feet if len(feet) else None,
            "contact": contact,
            "obstacles": obstacles if len(obstacles) else None,
            "bodies": bodies if len(bodies) else None,
        }
        source = _core.Source.of_mesh(name, mesh, _plain(description, "description"), "", [])
        self._take(_core.Robot(source, True))

    @classmethod
    def from_meshio(cls, mesh: meshio.Mesh, *, regions: Mapping[str, Any] | None = None, **description: Any) -> Robot:
        """A robot of a meshio.Mesh; its cell sets, point sets and physical groups are regions.

        description  as of Robot(...)
        """
        return cls._of_elements(neighbours.from_meshio(mesh), regions, description)

    @classmethod
    def from_pyvista(
        cls, grid: pyvista.UnstructuredGrid, *, regions: Mapping[str, Any] | None = None, **description: Any
    ) -> Robot:
        """A robot of a pyvista.UnstructuredGrid; the values of its cell array `region` are regions, named by
        the field data `region_NAME`, else region_0, ...

        description  as of Robot(...)
        """
        return cls._of_elements(neighbours.from_pyvista(grid), regions, description)

    @classmethod
    def _of_elements(
        cls, read: neighbours.Elements, regions: Mapping[str, Any] | None, description: dict[str, Any]
    ) -> Robot:
        return cls(**{**read.arguments(), "regions": {**read.regions, **(regions or {})}}, **description)

    @classmethod
    def _of(cls, core: _core.Robot) -> Robot:
        robot = cls.__new__(cls)
        robot._take(core)
        return robot

    def _take(self, core: _core.Robot) -> None:
        self._core = core
        self._owner = self
        self._session = None
        self._infos = core.actuators
        self._places = {info.name: i for i, info in enumerate(self._infos)}
        self._markers = core.markers
        self._supports = core.supports
        self._rest_actuation: Floats = core.rest_actuation()
        for warning in core.warnings:
            warnings.warn(warning, SoftkinWarning, stacklevel=4)

    def _place(self, name: str) -> int:
        place = self._places.get(name)
        return self._core.actuator(name) if place is None else place

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

    def session(self) -> Session:
        """For a control loop: keeps threads and factors, and goes on from its last shape."""
        from .session import Session

        return Session(self)

    def __reduce__(self) -> tuple[Callable[[bytes], Robot], tuple[bytes]]:
        return _unpickled, (self._core.pickled(),)

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
        from html import escape

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


def load(
    scene: str | os.PathLike[str],
    *,
    formulation: str | None = None,
    forces: Forces | None = None,
    changes: Mapping[str, object] | None = None,
) -> Robot:
    """The robot of a scene (YAML, docs/scene.md), with the files that it names.

    formulation  'physical' or 'target-shape'; None: the scene's
    forces       other sizes and directions for the scene's forces, by name: (x, y, z) [N]
    changes      other values for anything in it, by path: {"materials.body.youngs_modulus": 0.8}
    raises       InvalidInput naming file and line, or the change
    """
    texts = [f"{path}={_yaml_text(value)}" for path, value in (changes or {}).items()]
    source = _core.Source.of_scene(os.fspath(scene), _formulation(formulation), _force_texts(forces), texts)
    return Robot._of(_core.Robot(source, True))


def _unpickled(state: bytes) -> Robot:
    """One robot for all pickles of it, as long as somebody holds it: shapes that come back share it."""
    key = hashlib.blake2b(state, digest_size=16).digest()
    robot = _unpickled_robots.get(key)
    if robot is None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SoftkinWarning)  # they were raised where it was made
            robot = Robot._of(_core.Robot(_core.Source.unpickled(state), False))
        _unpickled_robots[key] = robot
    return robot


# what annotations of the mixins name
_ = (Command, FollowRun, Grasp, KinematicMap, PathRun, WalkRun)
