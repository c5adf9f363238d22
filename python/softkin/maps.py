"""Kinematic maps: a robot in closed form."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any, Literal, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arrays import Floats, floats
from ._compiled import Compiled
from ._core import InvalidInput
from ._files import PathLike, ending
from ._warning import warn
from .solver import Solver, options_of

__all__ = ["KinematicMap", "MapAnswer", "MapCheck", "MapInput", "MapOutput", "MapProgress", "load_map"]

Numbers = ArrayLike | Mapping[str, float]


class MapProgress(NamedTuple):
    """What the making of a map tells while it runs."""

    equilibria: int
    checks: int
    """solved so far"""
    error: float
    """of the last predictions, over the accuracy that is wanted; inf at first"""
    doing: str
    """'all cables taut', 'tendon2 slack', 'checking'"""


@dataclass(frozen=True)
class MapInput:
    """A command that a map takes."""

    name: str
    """of the actuator"""
    unit: str
    """'kPa', 'N', 'mT', 'A', 'mm' or 'A m^2'; '' for a ratio to rest [-]"""
    range: tuple[float, float]
    rest: float
    """where none is given"""


@dataclass(frozen=True)
class MapOutput:
    """A number that a map gives."""

    name: str
    """'tip_x', 'air_pressure', 'tendon1_ratio'"""
    unit: str
    """'mm', 'kPa', 'N' or ''"""
    accuracy: float
    """that was asked for, in its unit"""
    largest_error: float
    """at the checks, in its unit"""
    mean_error: float

    @property
    def column(self) -> str:
        """Of tables: 'tip_x_mm', 'air_pressure_kPa', 'tendon1_ratio'."""
        return f"{self.name}_{self.unit}" if self.unit else self.name


@dataclass(frozen=True)
class MapCheck:
    """How far a map was from the solver at random actuations that it was not made of. Not a bound."""

    points: int
    """that were compared"""
    outside: int
    """of the random ones, that the map refuses or the robot has no equilibrium for"""
    seed: int
    shape_accuracy_mm: float
    """that was asked for of every vertex; 0: the map has no shape"""
    shape_largest_mm: float
    """of any vertex at any point"""
    shape_mean_mm: float
    """of the farthest vertex, mean over the points"""
    strain_largest: float
    """of the body's least and greatest principal strain, taken from the shape"""


@dataclass(frozen=True, eq=False)
class MapAnswer:
    """What a map says of commands: of one set, or of N, where every array has a row for each."""

    commands: Floats
    """(i,) or (N, i)"""
    outputs: Floats
    """(q,) or (N, q), in the order of the map's outputs, in their units"""
    inside: NDArray[np.bool_]
    """() or (all,): which of the commands that were asked for are inside the map; those are the N"""
    jacobians: Floats | None
    """(q, i) or (N, q, i) [unit of the output per unit of the command]; None: not asked for"""
    of: tuple[MapOutput, ...]
    """the map's outputs"""

    @cached_property
    def _markers(self) -> dict[str, int]:
        return _markers(self.of)

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

        raises  ValueError where jacobian=True was not said
        """
        if self.jacobians is None:
            raise ValueError("the Jacobian was not asked for: solve(..., jacobian=True)")
        if marker is None:
            return self.jacobians
        place = self._marker(marker)
        return self.jacobians[..., place : place + 3, :]

    def __repr__(self) -> str:
        if self.outputs.ndim > 1:
            return f"<softkin.MapAnswer to {len(self.outputs)} of {len(self.inside)} commands>"
        places = "; ".join(f"{name} {', '.join(f'{x:.6g}' for x in at)} mm" for name, at in self.markers.items())
        return f"<softkin.MapAnswer {places}>"


def _markers(outputs: tuple[MapOutput, ...]) -> dict[str, int]:
    """Where the x of each marker is."""
    return {output.name[:-2]: q for q, output in enumerate(outputs) if output.unit == "mm" and output.name[-2:] == "_x"}


class KinematicMap:
    """A robot's equilibria in closed form; immutable. Threads may share it; the robot need not be there."""

    def __init__(self, core: _core.Map) -> None:
        self._core = core
        self._inputs = tuple(MapInput(name, unit, (low, high), rest) for name, unit, low, high, rest in core.inputs)
        self._outputs = tuple(MapOutput(*told) for told in core.outputs)
        self._places = {each.name: i for i, each in enumerate(self._inputs)}
        self._rest: Floats = np.array([each.rest for each in self._inputs])
        self._sessions: WeakKeyDictionary[Compiled, dict[bool, _core.Session]] = WeakKeyDictionary()

    @property
    def inputs(self) -> list[MapInput]:
        """Commands in the order of every (i,) array."""
        return list(self._inputs)

    @property
    def outputs(self) -> list[MapOutput]:
        """Markers, pressures, tensions and ratios in the order of every (q,) array, with their errors."""
        return list(self._outputs)

    @property
    def markers(self) -> list[str]:
        return list(_markers(self._outputs))

    @property
    def ranges(self) -> Floats:
        """(i, 2) least and greatest command."""
        return np.array([each.range for each in self._inputs])

    @cached_property
    def check(self) -> MapCheck:
        """At how many points the map was compared with the solver; `outputs` have the errors of each."""
        points, outside, seed, _, *shape = self._core.check
        return MapCheck(points, outside, seed, *shape)

    @property
    def vertices(self) -> int:
        """That `shape` gives; 0: the map was made without it."""
        return self._core.check[3]

    @property
    def accurate(self) -> bool:
        """Was no check farther off than what was asked for?"""
        check = self.check
        shape = check.shape_largest_mm <= check.shape_accuracy_mm or not self.vertices
        return check.points > 0 and shape and all(each.largest_error <= each.accuracy for each in self._outputs)

    @property
    def equilibria(self) -> int:
        """That it was made of."""
        return self._core.equilibria

    @property
    def robot_name(self) -> str:
        return self._core.robot_name

    @property
    def robot_fingerprint(self) -> str:
        """That of the robot: a map does not go with another one."""
        return self._core.robot

    def _commands(self, given: Numbers | None, named: Mapping[str, float]) -> Floats:
        if given is not None and not isinstance(given, Mapping):
            if named:
                raise ValueError("commands: an array names every input")
            many = (None,) if np.ndim(given) > 1 else ()
            return floats("commands", given, (*many, len(self._inputs)))
        found = self._rest.copy()
        for name, value in {**(given or {}), **named}.items():
            place = self._places.get(name)
            if place is None:
                raise InvalidInput(f"the map has no input {name!r}, but {', '.join(map(repr, self._places))}")
            number = float(value)
            if not math.isfinite(number):
                raise ValueError(f"{name} must be a finite number, not {number}")
            found[place] = number
        return found

    def solve(
        self,
        commands: Numbers | None = None,
        /,
        *,
        jacobian: bool = False,
        outside: Literal["raise", "leave out"] = "raise",
        threads: int = 1,
        **named: float,
    ) -> MapAnswer:
        """Markers, loads and ratios under given commands, in microseconds.

        commands  (i,) in the order of `inputs`, or by name, also as keywords: air1=1.3; each in its input's unit, the
                  others rest. (N, i): N of them at once
        jacobian  are derivatives wanted, too?
        outside   commands outside the map: 'raise'; 'leave out', of N: the answer has the others, and its `inside`
                  tells which. There are no rows of NaN, which a controller would pass on to a valve
        threads   of many rows; 0: as many as the machine has; the result is the same
        raises    InvalidInput naming the first row, and the command, outside the map
        """
        if outside not in ("raise", "leave out"):
            raise ValueError(f"outside must be 'raise' or 'leave out', not {outside!r}")
        given = self._commands(commands, named)
        rows = given if given.ndim == 2 else given[None]
        outputs, sloped, flags = self._core.solve(rows, jacobian, threads)
        jacobians = None if sloped is None else sloped.transpose(0, 2, 1)
        inside = flags.view(np.bool_)
        if given.ndim == 1:
            if not inside[0]:
                raise InvalidInput(self._core.refusal(given))
            one = None if jacobians is None else jacobians[0]
            return MapAnswer(given, outputs[0], inside[0], one, self._outputs)
        if not inside.all():
            if outside == "raise":
                first = int(inside.argmin())
                raise InvalidInput(
                    f"commands[{first}]: {self._core.refusal(rows[first])}; {np.count_nonzero(~inside)} of {len(rows)} "
                    "rows are outside"
                )
            rows, outputs = rows[inside], outputs[inside]
            jacobians = None if jacobians is None else jacobians[inside]
        return MapAnswer(rows, outputs, inside, jacobians, self._outputs)

    def shape(self, commands: Numbers | None = None, /, **named: float) -> Floats:
        """(n, 3) the robot's vertices [mm] under one set of commands, given as to `solve`.

        raises  InvalidInput outside the map, and where it was made without the shape
        """
        given = self._commands(commands, named)
        if given.ndim != 1:
            raise ValueError(f"commands must have shape ({len(self._inputs)},), not {given.shape}: a shape at a time")
        return self._core.shape(given)

    def save(self, path: PathLike) -> None:
        """A .skmap, as `softkin map` writes it."""
        self._core.save(ending("path", path, ".skmap"))

    def export_c(self, path: PathLike, *, floats: bool = False) -> None:
        """A header of C99, .h, that includes nothing: outputs, Jacobian, inverse kinematics.

        floats  numbers of 4 bytes in place of 8
        """
        self._core.save_c(ending("path", path, ".h"), floats)

    def export_js(self, path: PathLike) -> None:
        """A module for browsers and node, .mjs, and beside it .d.mts with its types."""
        file = ending("path", path, ".mjs")
        self._core.save_js(file, os.fspath(Path(file).with_suffix(".d.mts")))

    def export_numpy(self, path: PathLike) -> None:
        """All arrays, .npz: examples/python/map_numpy.py reads them with numpy alone."""
        self._core.save_npz(ending("path", path, ".npz"))

    def _session(self, robot: Compiled, polish: bool) -> _core.Session:
        """What answers in the solver's place, or gives it its starts."""
        made = self._sessions.setdefault(robot, {})
        if polish not in made:
            made[polish] = _core.Session(robot._core, self._core, polish)
        return made[polish]

    def __reduce__(self) -> tuple[Callable[[bytes, str], KinematicMap], tuple[bytes, str]]:
        return _unpickled, (self._core.pickled(), self._core.name)

    def __repr__(self) -> str:
        text = "; ".join(self._core.text().splitlines())
        return f"<softkin.KinematicMap of {self.robot_name}: {text}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(each.column)}</td><td>{each.largest_error:.2g}</td><td>{each.mean_error:.2g}</td>"
            f"<td>{each.accuracy:.2g}</td></tr>"
            for each in self._outputs
        )
        head = "<tr><th>output</th><th>largest error</th><th>mean</th><th>asked for</th></tr>"
        return f"<p>{escape(repr(self)[1:-1])}</p><table>{head}{rows}</table>"


def load_map(path: PathLike) -> KinematicMap:
    """The map of a file that `save` or `softkin map` wrote.

    raises  InvalidInput naming the file
    """
    return KinematicMap(_core.Map.of_file(os.fspath(path)))


def _unpickled(state: bytes, name: str) -> KinematicMap:
    return KinematicMap(_core.Map.unpickled(state, name))


def check_map(map: KinematicMap | None, polish: bool, options: _core.SolveOptions) -> None:
    if map is None and polish:
        raise ValueError("polish goes on from the answers of a map: it needs map")
    if map is not None and not polish and options.for_the_solver:
        raise ValueError("a map answers without the solver: the solver's options need polish=True")


def session_of(
    robot: Compiled, map: KinematicMap | None, polish: bool, options: _core.SolveOptions, own: _core.Session | None
) -> _core.Session | None:
    """What solves: a map, where there is one."""
    check_map(map, polish, options)
    return own if map is None else map._session(robot, polish)


def made(
    robot: Compiled,
    accuracy_mm: float,
    load_accuracy: float | None,
    shape_accuracy_mm: float | None,
    most: int,
    checks: int,
    seed: int,
    store: PathLike | None,
    progress: Callable[[MapProgress], Any] | None,
    solver: Solver,
) -> KinematicMap:
    for name, value in (("load_accuracy", load_accuracy), ("shape_accuracy_mm", shape_accuracy_mm)):
        if value is not None and not 0 < value < math.inf:
            raise ValueError(f"{name} must be a number > 0, or None, not {value}")
    accuracies = (accuracy_mm, load_accuracy or 0.0, shape_accuracy_mm or 0.0)
    statics = options_of(replace(solver, threads=1))
    options = _core.MapOptions(*accuracies, most, checks, seed, statics, solver.threads)

    def told(equilibria: int, checked: int, error: float, doing: str) -> None:
        assert progress is not None
        progress(MapProgress(equilibria, checked, error, doing))

    file = "" if store is None else ending("store", store, ".skmap")
    core, remark = _core.make_map(robot._core, options, file, None if progress is None else told)
    if remark:
        warn(f"the map is not as accurate as was asked for: {remark}")
    return KinematicMap(core)
