"""Kinematic maps: a robot in closed form."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from html import escape
from pathlib import Path
from typing import Any, Literal
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, dimensions, floats
from ._compiled import Compiled
from ._core import InvalidInput
from ._files import PathLike, ending
from ._kinds import number_of, reading_of, shown
from ._warning import warn
from .map_answer import MapAnswer, MapCheck, MapEstimate, MapInput, MapOutput, MapProgress, markers_of
from .solver import Solver, options_of

__all__ = ["KinematicMap", "load_map"]

Numbers = ArrayLike | Mapping[str, float]
Readings = Mapping[str, float | None]


class KinematicMap:
    """A robot's equilibria in closed form; immutable and thread-safe. It works without the robot."""

    def __init__(self, core: _core.Map) -> None:
        self._core = core
        self._inputs = tuple(MapInput(name, unit, (low, high), rest) for name, unit, low, high, rest in core.inputs)
        self._outputs = tuple(MapOutput(*fields) for fields in core.outputs)
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
        return list(markers_of(self._outputs))

    @property
    def ranges(self) -> Floats:
        """(i, 2) minimum and maximum command."""
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
        """Is every error at the checks within the requested accuracy?"""
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
                raise InvalidInput("commands: an array names every input")
            many = (None,) if dimensions("commands", given) > 1 else ()
            return floats("commands", given, (*many, len(self._inputs)))
        found = self._rest.copy()
        for name in named:
            if given is not None and name in given:
                raise InvalidInput(f"{name} is given twice: among the commands by name and as a keyword")
        for name, value in {**(given or {}), **named}.items():
            place = self._places.get(name)
            if place is None:
                raise InvalidInput(f"the map has no input {name!r}, but {', '.join(map(repr, self._places))}")
            found[place] = number_of(name, value)
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
                  marks which. There are no rows of NaN, which a controller would pass on to a valve
        threads   of many rows; 0: as many as the machine has; the result is the same
        raises    InvalidInput naming the first row, and the command, outside the map
        """
        if outside not in ("raise", "leave out"):
            raise InvalidInput(f"outside must be 'raise' or 'leave out', not {outside!r}")
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

    def estimate(
        self,
        readings: Readings,
        deviations: Mapping[str, float] | float,
        unknowns: Mapping[str, tuple[float, float]],
        commands: Numbers | None = None,
        /,
        **named: float,
    ) -> MapEstimate:
        """Commands that were not measured, such as forces, from outputs that were read: the most probable ones inside
        their ranges, in microseconds. docs/maps.md

        readings    by the columns of outputs: tip_x_mm, air_pressure_kPa; NaN: not read
        deviations  of each, > 0, in its unit; a number: of all of them
        unknowns    inputs to be estimated: prior mean and standard deviation
        commands    the others, as to `solve`; of the unknowns where the search begins, their means if they are not there
        raises      InvalidInput naming an unknown output or input; where the search begins outside the map
        """
        if not isinstance(readings, Mapping):
            raise InvalidInput(f"readings must be a dictionary, not {shown(readings)}")
        columns = {each.column: q for q, each in enumerate(self._outputs)}
        values, off = np.full(len(columns), np.nan), np.ones(len(columns))
        for name, value in readings.items():
            if name not in columns:
                raise InvalidInput(f"the map has no output {name!r}, but {', '.join(map(repr, columns))}")
            values[columns[name]] = reading_of(name, value)
            if isinstance(deviations, Mapping) and name not in deviations:
                raise InvalidInput(f"the reading {name!r} needs a deviation")
            off[columns[name]] = deviations[name] if isinstance(deviations, Mapping) else deviations
        means = {name: mean for name, (mean, _) in unknowns.items()}
        given = self._commands(commands, named if commands is not None else {**means, **named})
        if given.ndim != 1:
            raise InvalidInput(f"commands must have shape ({len(self._inputs)},), not {given.shape}: readings at a time")
        for name in unknowns:
            if name not in self._places:
                raise InvalidInput(f"the map has no input {name!r}, but {', '.join(map(repr, self._places))}")
        before = np.array([unknowns[name] for name in unknowns], dtype=np.float64).reshape(-1, 2)
        places = [self._places[name] for name in unknowns]
        estimated, covariance, computed, chi_square, freedoms, misfit, converged = self._core.estimate(
            places, np.ascontiguousarray(before[:, 0]), np.ascontiguousarray(before[:, 1]), given, values, off
        )
        answer = MapAnswer(estimated, computed, np.array(True), None, self._outputs)
        found = {name: float(estimated[i]) for name, i in zip(unknowns, places, strict=True)}
        left = dict(zip(unknowns, np.sqrt(np.diag(covariance)).tolist(), strict=True))
        return MapEstimate(found, left, covariance, answer, chi_square, freedoms, misfit, converged)

    def shape(self, commands: Numbers | None = None, /, **named: float) -> Floats:
        """(n, 3) the robot's vertices [mm] under one set of commands, given as to `solve`.

        raises  InvalidInput outside the map, and where it was made without the shape
        """
        given = self._commands(commands, named)
        if given.ndim != 1:
            raise InvalidInput(f"commands must have shape ({len(self._inputs)},), not {given.shape}: a shape at a time")
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
        """The session in which the map replaces the solver or, with `polish`, provides its initial guesses."""
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
        head = "<tr><th>output</th><th>largest error</th><th>mean</th><th>accuracy</th></tr>"
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
        raise InvalidInput("polish goes on from the answers of a map: it needs map")
    if map is not None and not polish and options.for_the_solver:
        raise InvalidInput("a map answers without the solver: the solver's options need polish=True")


def session_of(
    robot: Compiled, map: KinematicMap | None, polish: bool, options: _core.SolveOptions, own: _core.Session | None
) -> _core.Session | None:
    """Returns the session of the map where one is given, otherwise `own`."""
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
            raise InvalidInput(f"{name} must be a number > 0, or None, not {value}")
    accuracies = (accuracy_mm, load_accuracy or 0.0, shape_accuracy_mm or 0.0)
    statics = options_of(replace(solver, threads=1))
    options = _core.MapOptions(*accuracies, most, checks, seed, statics, solver.threads)

    def report(equilibria: int, checked: int, error: float, doing: str) -> None:
        assert progress is not None
        progress(MapProgress(equilibria, checked, error, doing))

    file = "" if store is None else ending("store", store, ".skmap")
    core, remark = _core.make_map(robot._core, options, file, None if progress is None else report)
    if remark:
        warn(f"the map is not as accurate as requested: {remark}")
    return KinematicMap(core)
