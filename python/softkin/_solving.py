"""What a robot and a session have in common: solve, inverse, Jacobian."""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, floats, vector
from .errors import SoftkinWarning
from .inverse import Answer
from .shape import Shape

if TYPE_CHECKING:
    from .maps import KinematicMap
    from .robot import Robot

Command = float | str
Commands = ArrayLike | Mapping[str, Command]
Target = Sequence[float | None] | Floats
DEFAULT_ITERATIONS = 50000


@dataclass(frozen=True)
class Sensitivity:
    """How an equilibrium changes with a number of the robot, per unit of it."""

    value: float
    """the number as it is"""
    positions: Floats
    """(n, 3) of the vertices [mm]"""
    markers: Mapping[str, Floats]
    """by name, (3,) [mm]"""
    loads: Mapping[str, float]
    """by actuator: of the pressure [kPa], tension [N] or voltage [kV] that it takes; 0 where it has none"""


class Progress(NamedTuple):
    """What a long solve tells while it runs."""

    iteration: int
    step_mm: float
    """largest move of a vertex in the last iteration [mm]; of inverse kinematics the least error so far [mm]"""
    tolerance_mm: float
    """the step, or error, at which it stops [mm]"""
    share: float
    """of the way to what was asked for [-]; < 0: not known"""


ProgressFunction = Callable[[Progress], object]


@lru_cache(maxsize=64)
def _options(
    solver: str,
    tolerance_mm: float | None,
    max_iterations: int,
    anderson: int,
    threads: int,
    stable: bool,
    elapsed_s: float | None = None,
    beyond: float | None = None,
    as_published: bool = False,
) -> _core.SolveOptions:
    if tolerance_mm is not None and not tolerance_mm > 0:
        raise ValueError(f"the tolerance must be a length > 0 in mm, not {tolerance_mm}")
    if beyond is not None and not beyond > 0:
        raise ValueError(f"beyond must be a volume or length > 0 over that at rest, not {beyond}")
    return _core.SolveOptions(
        solver, tolerance_mm or 0.0, max_iterations, anderson, threads, stable, elapsed_s, beyond or 0.0, as_published
    )


def _within(options: _core.SolveOptions, budget_s: float | None) -> _core.SolveOptions:
    return options if budget_s is None else options.within(budget_s)


def _telling(progress: ProgressFunction) -> Callable[[int, float, float, float], bool]:
    def told(iteration: int, step_mm: float, tolerance_mm: float, share: float) -> bool:
        return progress(Progress(iteration, step_mm, tolerance_mm, share)) is not False

    return told


def _check_map(map: KinematicMap | None, polish: bool, options: _core.SolveOptions) -> None:
    if map is None and polish:
        raise ValueError("polish goes on from the answers of a map: it needs map")
    if map is not None and not polish and options.for_the_solver:
        raise ValueError("a map answers without the solver: the solver's options need polish=True")


def _chosen_start(
    goals: _core.Goals, start: Shape | Commands | None, workspace: str | os.PathLike[str] | None
) -> Shape | Commands | None:
    if workspace is None:
        return start
    if start is not None:
        raise ValueError("workspace chooses the start: it does not go with start")
    return goals.nearest_sample(os.fspath(workspace))


class Solving:
    """Solves for a robot; of a session with what it keeps."""

    _owner: Robot
    _session: _core.Session | None

    def _actuation(self, given: Commands | None, named: Mapping[str, Command]) -> Floats:
        """Commands in the order of the robot's actuators; those that are not given rest."""
        robot = self._owner
        if given is None:
            values = robot._rest_actuation.copy()
        elif isinstance(given, Mapping):
            values = self._actuation(None, given)
        else:
            values = floats("actuation", given, (len(robot._places),)).copy()
        places = robot._places
        for name, value in named.items():
            place = places.get(name)
            number = value if type(value) is float and math.isfinite(value) else self._number(name, value)
            values[robot._place(name) if place is None else place] = number
        return values

    def _number(self, name: str, value: Command) -> float:
        if isinstance(value, str):
            return self._owner._core.parsed("command", name, value)
        number = float(value)
        if not math.isfinite(number):
            raise ValueError(f"{name} must be a finite number, not {number}")
        return number

    def _by(
        self, map: KinematicMap | None, polish: bool, options: _core.SolveOptions
    ) -> _core.Session | None:
        """What solves: a map, where there is one."""
        _check_map(map, polish, options)
        return self._session if map is None else map._session(self._owner, polish)

    def _solve(
        self,
        asked: Floats,
        start: Shape | ArrayLike | str | os.PathLike[str] | None,
        by: _core.Session | None,
        options: _core.SolveOptions,
        progress: ProgressFunction | None,
    ) -> Shape:
        robot = self._owner
        begin = positions = file = None
        if isinstance(start, Shape):
            begin = start._core
        elif isinstance(start, (str, os.PathLike)):
            file = os.fspath(start)
        elif start is not None:
            positions = floats("start", start, (len(robot.rest), 3))
        tell = None if progress is None else _telling(progress)
        return Shape(robot, _core.solve(robot._core, by, asked, begin, positions, file, options, tell))

    def solve(
        self,
        actuation: Commands | None = None,
        /,
        *,
        start: Shape | ArrayLike | str | os.PathLike[str] | None = None,
        map: KinematicMap | None = None,
        polish: bool = False,
        solver: str = "newton",
        tolerance_mm: float | None = None,
        max_iterations: int = DEFAULT_ITERATIONS,
        anderson: int = 6,
        threads: int = 0,
        stable: bool = False,
        beyond: float | None = None,
        as_published: bool = False,
        elapsed_s: float | None = None,
        budget_s: float | None = None,
        progress: ProgressFunction | None = None,
        **commands: Command,
    ) -> Shape:
        """The shape under given commands; actuators without one rest.

        actuation       (m,) in the order of `robot.actuators`, or commands by name
        commands        by the actuator's name: a number in its unit, or a text with one: air="50 kPa"
        start           shape where the search begins, a .vtu file that softkin wrote, or (n, 3) positions [mm]; None:
                        rest
        map             of this robot: answers in the solver's place; outside of it the status is 'limit'
        polish          the solver goes on from the map's answer
        solver          'newton', or for target shapes 'local-global': Algorithm 1 of the paper
        tolerance_mm    largest move of a vertex at which it stops [mm]; None: 8e-8 of the robot's size
        max_iterations  >= 1
        anderson        local-global: earlier steps that are combined, 0 to 20
        threads         0: as many as the machine has and the robot is worth; the result is the same
        stable          physical: leave an unstable equilibrium along its lowest mode for a stable one
        beyond          physical: where a pressure or tension comes to its maximum, the way goes on beyond it, where it
                        falls, to this volume or length over that at rest [-]; None: it ends at the maximum
        as_published    local-global: stop where the program of the paper's authors does, without acceleration: from the
                        tenth iteration on when no marker moves by 0.032 mm; no equilibrium
        elapsed_s       viscous: time since the shape `start`, which the material remembers, without one since a long
                        rest [s]; 0: the instant answer; None: the relaxed one, whatever was before
        budget_s        ends after so long, 'not converged', with the last good shape on the way [s]; None: never
        progress        called with a Progress at most 20 times a second; False stops the solve
        returns         not converging is its status
        """
        options = _within(
            _options(solver, tolerance_mm, max_iterations, anderson, threads, stable, elapsed_s, beyond, as_published),
            budget_s,
        )
        by = self._by(map, polish, options)
        return self._solve(self._actuation(actuation, commands), start, by, options, progress)

    def jacobian(self, shape: Shape, markers: str | Sequence[str] | None = None) -> Floats:
        """Derivatives of marker positions by commands.

        shape    an equilibrium that a solve of this robot returned
        markers  one, or several; None: all
        returns  (3p, m): x, y, z of each marker [mm per unit of command: 1 (ratio), N or kPa], columns in the order
                 of `robot.actuators`
        raises   InvalidInput where the shape stands at a limit of existence or a branch
        """
        robot = self._owner
        if shape.robot is not robot:
            raise ValueError("shape is one of another robot")
        names = robot.markers if markers is None else [markers] if isinstance(markers, str) else list(markers)
        return _core.jacobian(shape._core, self._session, [robot._core.marker(name) for name in names])

    def sensitivity(self, shape: Shape, numbers: str | Sequence[str]) -> dict[str, Sensitivity]:
        """Derivatives of an equilibrium by numbers of the robot, commands held.

        shape    an equilibrium that a solve of this robot returned; physical
        numbers  one or several, each a path as of `load(changes=)`: "materials.body.youngs_modulus",
                 "actuators.tendon.friction", "forces.payload.force.3"; not of the mesh
        returns  by number; where cables rub, of going on in the direction in which they slipped
        raises   InvalidInput naming the number that the robot has not, or where the shape stands at a limit of
                 existence or a branch
        """
        robot = self._owner
        if shape.robot is not robot:
            raise ValueError("shape is one of another robot")
        names = [numbers] if isinstance(numbers, str) else list(numbers)
        found = _core.sensitivity(shape._core, names)
        return {
            name: Sensitivity(
                value,
                positions,
                dict(zip(robot.markers, markers)),
                {info.name: float(load) for info, load in zip(robot.actuator_infos, loads)},
            )
            for name, (value, positions, markers, loads) in zip(names, found)
        }

    def _goals(
        self,
        targets: Mapping[str, Target],
        planes: Mapping[str, tuple[Sequence[float], Sequence[float]]] | None,
        directions: Mapping[tuple[str, str], Sequence[float]] | None,
        lever_mm: float | None,
        weights: Mapping[str | tuple[str, str], float] | None,
    ) -> _core.Goals:
        left = dict(weights or {})
        goals = _core.Goals(self._owner._core)
        for marker, target in targets.items():
            if len(target) != 3:
                raise ValueError(f"the target of {marker!r} must be three coordinates [mm], not {len(target)}")
            axes = [value is not None for value in target]
            place = vector(f"the target of {marker!r}", [0.0 if value is None else value for value in target])
            goals.position(marker, place, (axes[0], axes[1], axes[2]), left.pop(marker, 1.0))
        for marker, (point, normal) in (planes or {}).items():
            goals.plane(marker, vector("planes: point", point), vector("planes: normal", normal), left.pop(marker, 1.0))
        for (first, second), direction in (directions or {}).items():
            weight = left.pop((first, second), 1.0)
            goals.direction(first, second, vector("directions", direction), lever_mm, weight)
        if left:
            raise ValueError(f"weights: nothing is asked of {next(iter(left))!r}")
        for doubt in goals.check():
            warnings.warn(doubt, SoftkinWarning, stacklevel=3)
        return goals

    def _solve_inverse(
        self,
        goals: _core.Goals,
        start: Shape | Commands | None,
        last: Answer | None,
        prefer: Mapping[str, Command] | None,
        fix: Mapping[str, Command] | Sequence[str] | None,
        by: _core.Session | None,
        options: _core.InverseOptions,
        progress: ProgressFunction | None,
    ) -> Answer:
        robot = self._owner
        fixed = dict(fix) if isinstance(fix, Mapping) else dict.fromkeys(fix or ())
        values = {name: value for name, value in fixed.items() if value is not None}
        free = [info.name not in fixed for info in robot.actuator_infos]
        for name in fixed:
            robot._place(name)
            if name in (prefer or {}):
                raise ValueError(f"fix: {name!r} does not change, so it takes no prefer")
        shape = start if isinstance(start, Shape) else None
        if shape is not None and values:
            raise ValueError("fix: with start=shape an actuator stays as it is there; give names without values")
        begin = None if shape is not None else self._actuation(start, values)  # type: ignore[arg-type]
        preferred = None
        if prefer:
            preferred = (shape.actuation if shape is not None else begin).copy()  # type: ignore[union-attr]
            for name, value in prefer.items():
                preferred[robot._place(name)] = self._number(name, value)
        core = _core.inverse(
            goals,
            by,
            begin,
            None if shape is None else shape._core,
            None if last is None else last._core,
            preferred,
            free,
            options,
            None if progress is None else _telling(progress),
        )
        return Answer(robot, core)

    def inverse(
        self,
        targets: Mapping[str, Target] | None = None,
        /,
        *,
        planes: Mapping[str, tuple[Sequence[float], Sequence[float]]] | None = None,
        directions: Mapping[tuple[str, str], Sequence[float]] | None = None,
        lever_mm: float | None = None,
        weights: Mapping[str | tuple[str, str], float] | None = None,
        start: Shape | Commands | None = None,
        workspace: str | os.PathLike[str] | None = None,
        prefer: Mapping[str, Command] | None = None,
        fix: Mapping[str, Command] | Sequence[str] | None = None,
        map: KinematicMap | None = None,
        polish: bool = False,
        method: str = "newton",
        tolerance_mm: float | None = None,
        max_equilibria: int = 200,
        descents: int = 30,
        other_starts: int = 3,
        solver: str = "newton",
        step_tolerance_mm: float | None = None,
        max_iterations: int = DEFAULT_ITERATIONS,
        anderson: int = 6,
        threads: int = 0,
        stable: bool = False,
        elapsed_s: float | None = None,
        budget_s: float | None = None,
        progress: ProgressFunction | None = None,
        **markers: Target,
    ) -> Answer:
        """The actuation that brings markers where they should be, or as near as the ranges allow.

        targets         by the marker's name: (x, y, z) [mm]; None for a coordinate that does not count. Also as
                        keywords: tip=(100, 0, None)
        planes          by the marker's name: a point [mm] and the normal of a plane for it to be in
        directions      by (from, to), two markers: where the line from one to the other is to point
        lever_mm        how far away a wrong direction counts [mm]; None: as far as its markers are apart at rest
        weights         in the sum of squares, by marker or (from, to); 1 where none is given
        start           an equilibrium, or commands as `solve` takes them; None: rest
        workspace       CSV of a workspace, in place of start: its sample nearest to the goals
        prefer          where several actuations reach the goals, the one nearest to these commands; None: to the start
        fix             actuators that do not change: names, or commands by name
        map, polish     as solve's
        method          'newton', or 'gradient': Algorithm 2 of Fang et al. 2020
        tolerance_mm    error of every goal at which they are reached [mm]; None: 0.001, gradient 0.2
        max_equilibria  newton: gives up after so many
        descents        gradient: iterations
        other_starts    newton: from where it is tried again before goals are called out of reach
        solver, step_tolerance_mm, max_iterations, anderson, threads, stable, elapsed_s  as solve's
        budget_s        of the whole search; it ends 'not converged', with the best so far [s]; None: never
        progress        as solve's
        """
        goals = self._goals({**(targets or {}), **markers}, planes, directions, lever_mm, weights)
        statics = _within(
            _options(solver, step_tolerance_mm, max_iterations, anderson, threads, stable, elapsed_s), budget_s
        )
        options = _core.InverseOptions(method, tolerance_mm, max_equilibria, descents, other_starts, statics)
        start = _chosen_start(goals, start, workspace)
        return self._solve_inverse(goals, start, None, prefer, fix, self._by(map, polish, statics), options, progress)
