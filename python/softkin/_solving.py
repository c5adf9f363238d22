"""The common methods of robots and sessions: solve, inverse, derivatives."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._arrays import Floats, floats
from ._compiled import Command, Commands
from ._core import InvalidInput
from ._files import PathLike
from ._kinds import named_file
from .inverse import Answer, Target, goals_of, places_of, searched, start_of
from .maps import KinematicMap, session_of
from .shape import Shape, warn_of
from .solver import OLD, OLD_OF_SEARCH, USUAL, ProgressFunction, Solver, options_of, progress_callback, with_old

if TYPE_CHECKING:
    from .robot import Robot


@dataclass(frozen=True)
class Sensitivity:
    """The sensitivity of an equilibrium to a parameter of the robot, per unit of the parameter."""

    value: float
    """present value of the parameter"""
    positions: Floats
    """(n, 3) of the vertices [mm]"""
    markers: Mapping[str, Floats]
    """by name, (3,) [mm]"""
    loads: Mapping[str, float]
    """by actuator: of the pressure [kPa], tension [N] or voltage [kV] that it takes; 0 where it has none"""


class Solving:
    """Solves for a robot; a session with what it keeps."""

    _owner: Robot
    _session: _core.Session | None = None
    _last: Shape | None = None
    """of a session, from which it goes on where no start is given"""
    _answer: Answer | None = None
    """that it is of, where it is one"""

    def solve(
        self,
        actuation: Commands | None = None,
        /,
        *,
        start: Shape | ArrayLike | PathLike | None = None,
        map: KinematicMap | None = None,
        polish: bool = False,
        solver: Solver | str = USUAL,
        beyond: float | None = None,
        elapsed_s: float | None = None,
        budget_s: float | None = None,
        progress: ProgressFunction | None = None,
        **commands: Command,
    ) -> Shape:
        """The shape under given commands; actuators without one rest.

        actuation  (m,) in the order of `robot.actuators`, or commands by name
        commands   by the actuator's name: a number in its unit, or a text with one: air="50 kPa"
        start      shape where the search begins, a .vtu file that softkin wrote, or (n, 3) positions [mm]; None: rest, of
                   a session its last equilibrium
        map        of this robot: answers in the solver's place; outside of it the status is 'limit'
        polish     the solver goes on from the map's answer
        solver     a Solver, or a method as usual: 'newton', 'local-global'
        beyond     physical: at a limit point of a pressure or tension the solve continues on the post-limit-point
                   branch, up to this ratio of volume or length to its rest value [-]; None: it ends there
        elapsed_s  viscous: time since the shape `start`, which the material remembers, without one since a long rest [s];
                   0: the instant answer; None: the relaxed one, whatever was before
        budget_s   time limit [s]; after it the status is 'not converged', and the shape is the last equilibrium of
                   the load path; None: no limit
        progress   called with a Progress at most 20 times a second; False stops the solve
        returns    a shape without convergence is returned too: see its `status`
        """
        if not OLD.isdisjoint(commands):
            solver = with_old("solve", solver, OLD, commands)
        options = options_of(solver, published=True, elapsed_s=elapsed_s, beyond=beyond, budget_s=budget_s)
        robot = self._owner
        by = session_of(robot, map, polish, options, self._session)
        requested = robot._actuation(actuation, commands)
        begin = self._last if start is None else start
        found = Shape(robot, _solved(robot._core, by, requested, begin, options, progress))
        if self._session is None and budget_s is None and found.status != "interrupted":
            warn_of(found._findings)
        elif self._session is not None and found.converged:
            self._last, self._answer = found, None
        return found

    def inverse(
        self,
        targets: Mapping[str, Target] | None = None,
        /,
        *,
        planes: Mapping[str, tuple[Sequence[float], Sequence[float]]] | None = None,
        directions: Mapping[tuple[str, str], Sequence[float]] | None = None,
        lever_mm: float | None = None,
        press: Mapping[str, Target] | None = None,
        weights: Mapping[str | tuple[str, str], float] | None = None,
        start: Shape | Commands | None = None,
        workspace: PathLike | None = None,
        prefer: Mapping[str, Command] | None = None,
        fix: Mapping[str, Command] | Sequence[str] | None = None,
        map: KinematicMap | None = None,
        polish: bool = False,
        method: str = "newton",
        tolerance_mm: float | None = None,
        tolerance_force_N: float | None = None,
        max_equilibria: int = 200,
        descents: int = 30,
        other_starts: int = 3,
        solver: Solver | str = USUAL,
        elapsed_s: float | None = None,
        budget_s: float | None = None,
        progress: ProgressFunction | None = None,
        **markers: Target,
    ) -> Answer:
        """Finds the actuation that brings markers and contact forces to their targets, or as near as the ranges allow.

        targets         by the marker's name: (x, y, z) [mm]; None for a coordinate that does not count. Also as
                        keywords: tip=(100, 0, None)
        planes          by the marker's name: a point [mm] and the normal of a plane for it to be in
        directions      by (from, to), two markers: where the line from one to the other is to point
        lever_mm        how far away a wrong direction counts [mm]; None: as far as its markers are apart at rest
        press           by the name of a support, an obstacle or a body: the force that the robot is to exert on it [N];
                        None for a component that does not count; physical
        weights         in the sum of squares, by marker, (from, to) or what is pressed; 1 where none is given
        start           an equilibrium, or commands as `solve` takes them; None: rest
        workspace       CSV of a workspace, in place of start: its sample nearest to the goals
        prefer          where several actuations reach the goals, the one nearest to these commands; None: to the start
        fix             actuators that do not change: names, or commands by name
        map, polish     as solve's
        method          'newton', or 'gradient': Algorithm 2 of Fang et al. 2020
        tolerance_mm    error of every goal at which they are reached [mm]; None: 0.001, gradient 0.2
        tolerance_force_N  error of every force at which it is reached [N]; None: 0.001 of it
        max_equilibria  newton: gives up after so many
        descents        gradient: iterations
        other_starts    newton: from where it is tried again before goals are called out of reach
        solver, elapsed_s, progress  as solve's
        budget_s        of the whole search; it ends 'not converged', with the best so far [s]; None: never
        """
        if not OLD_OF_SEARCH.isdisjoint(markers):
            solver = with_old("inverse", solver, OLD_OF_SEARCH, markers)
        robot = self._owner
        statics = options_of(solver, elapsed_s=elapsed_s, budget_s=budget_s)
        options = _core.InverseOptions(method, tolerance_mm, max_equilibria, descents, other_starts, statics)
        places, tolerances = places_of(robot, targets, markers), (options.tolerance_mm, tolerance_force_N)
        goals = goals_of(robot, places, planes, directions, lever_mm, press, tolerances, weights)
        start = start_of(goals, start, workspace)
        begin, last = (self._last, self._answer) if start is None else (start, None)
        by = session_of(robot, map, polish, statics, self._session)
        found = Answer(robot, searched(robot, goals, begin, last, prefer, fix, by, options, progress))
        if self._session is None and budget_s is None and found._core.has_shape and found.status != "interrupted":
            warn_of(found.shape._findings)
        elif self._session is not None and found.shape.converged:
            self._last, self._answer = found.shape, found
        return found

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
            raise InvalidInput("shape is one of another robot")
        names = robot.markers if markers is None else [markers] if isinstance(markers, str) else list(markers)
        return _core.jacobian(shape._core, self._session, [robot._core.marker(name) for name in names])

    def sensitivity(self, shape: Shape, numbers: str | Sequence[str]) -> dict[str, Sensitivity]:
        """Derivatives of an equilibrium by numbers of the robot, commands held.

        shape    an equilibrium that a solve of this robot returned; physical
        numbers  one or several, each a path as of `load(changes=)`: "materials.body.youngs_modulus",
                 "actuators.tendon.friction", "forces.payload.force.3"; not of the mesh
        returns  by number; for cables with friction, the derivatives for continued slip in the present direction
        raises   InvalidInput naming the number that the robot does not have, or where the shape stands at a limit of
                 existence or a branch
        """
        robot = self._owner
        if shape.robot is not robot:
            raise InvalidInput("shape is one of another robot")
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

    def gradient(
        self,
        shape: Shape,
        numbers: str | Sequence[str],
        *,
        positions: ArrayLike | None = None,
        markers: Mapping[str, ArrayLike] | None = None,
        loads: Mapping[str, float] | None = None,
    ) -> dict[str, float]:
        """Derivatives of one value that an equilibrium is given, such as a loss, by numbers of the robot, commands
        held: the chain rule by the adjoint, with one linear solve for all numbers (with friction, one for each).

        shape      an equilibrium that a solve of this robot returned; physical
        numbers    as of sensitivity()
        positions  (n, 3), the value's derivatives by the vertices' places [1/mm]; none: it does not depend on them
        markers    by name, (3,): the same by markers [1/mm]
        loads      by actuator: by its pressure [1/kPa] or tension [1/N]
        returns    by number
        raises     InvalidInput as sensitivity(); ValueError on an unknown marker or actuator
        """
        robot = self._owner
        if shape.robot is not robot:
            raise InvalidInput("shape is one of another robot")
        names = [numbers] if isinstance(numbers, str) else list(numbers)
        count = len(robot.rest)
        by_positions = np.zeros((count, 3)) if positions is None else floats("positions", positions, (count, 3))
        by_markers = np.zeros((len(robot.markers), 3))
        for name, by in (markers or {}).items():
            by_markers[robot._core.marker(name)] = floats(f"markers {name!r}", by, (3,))
        actuators = [info.name for info in robot.actuator_infos]
        by_loads = np.zeros(len(actuators))
        for name, load in (loads or {}).items():
            if name not in actuators:
                raise InvalidInput(f"loads names {name!r}, which is no actuator; there are {', '.join(actuators)}")
            by_loads[actuators.index(name)] = load
        found = _core.gradient(shape._core, names, by_positions, by_markers, by_loads)
        return dict(zip(names, found.tolist()))


def _solved(
    robot: _core.Robot,
    by: _core.Session | None,
    requested: Floats,
    start: Shape | ArrayLike | PathLike | None,
    options: _core.SolveOptions,
    progress: ProgressFunction | None,
) -> _core.Shape:
    begin = positions = file = None
    if isinstance(start, Shape):
        begin = start._core
    elif isinstance(start, (str, os.PathLike)):
        file = named_file("start", start)
    elif start is not None:
        positions = floats("start", start, (len(robot.rest), 3))
    report = None if progress is None else progress_callback(progress)
    return _core.solve(robot, by, requested, begin, positions, file, options, report)
