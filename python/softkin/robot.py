"""Robots: made of a scene, or of arrays in memory, and what is done with them."""

from __future__ import annotations

import hashlib
import os
import warnings
import weakref
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike

from . import _core
from ._compiled import Command, Commands, Compiled
from ._core import InvalidInput
from ._description import Forces, changes_of, force_texts, formulation_of
from ._files import PathLike, optional
from ._solving import Solving
from ._warning import SoftkinWarning
from .estimate import Estimator
from .grasp import AXES, Direction, Grasp, grasped
from .map_answer import MapProgress
from .maps import KinematicMap, check_map, made
from .page import DEFAULT_HEIGHT, PageView, page
from .runs import FollowRun, PathRun, Steps, remarked, steps_of, waypoints_of
from .session import Session
from .shape import Shape
from .solver import USUAL, ProgressFunction, Solver, options_of, takes_old, value_of
from .walk import WalkRun
from .workspace import ProgressBar, Workspace, sampled

__all__ = ["Robot", "load"]

_unpickled_robots: weakref.WeakValueDictionary[bytes, Robot] = weakref.WeakValueDictionary()


class Robot(Compiled, Solving):
    """A compiled robot; immutable. Solves are independent of each other, so that several threads may use one robot."""

    def _take(self, core: _core.Robot) -> None:
        super()._take(core)
        self._owner = self

    def estimator(
        self,
        unknowns: str | Sequence[str],
        deviations: Mapping[str, float],
        *,
        fade_s: float = 0,
        leave_out: bool = True,
        solver: Solver | str = USUAL,
    ) -> Estimator:
        """Estimates external forces, their places and the shape from a few readings. docs/estimate.md

        unknowns    'touch': a force or wrench that has a range; 'touch:place': and where on its region; 'air': a command
                    that is not measured, or a pressure on the surface; each with '=0+-0.5' where it is known before;
                    'materials.body.stiffness=1+-0.2': over what the description says
        deviations  of the readings by their columns: {'tip_x_mm': 0.2, 'air_volume_mm3': 20}
        fade_s      time after which the forces may have changed arbitrarily [s]; 0: each update is independent
        leave_out   readings that contradict the others
        """
        return Estimator(self, unknowns, deviations, fade_s=fade_s, leave_out=leave_out, solver=solver)

    def session(self) -> Session:
        """For a control loop: keeps threads and factors, and goes on from its last shape."""
        return Session(self)

    @takes_old
    def path(
        self,
        steps: Steps,
        *,
        times: ArrayLike | None = None,
        store: PathLike | None = None,
        map: KinematicMap | None = None,
        polish: bool = False,
        solver: Solver | str = USUAL,
        **commands: Command,
    ) -> PathRun:
        """The shapes along a path of commands, each solved from the last: an iterator.

        steps     (k, m) commands in the order of `robot.actuators`; commands by name for each step; or a CSV file
        times     (k,) [s], ascending
        store     folder of report.json and path.pvd with the shapes: a run that was stopped goes on where it was
        commands  of actuators that the steps do not name
        map       of this robot: answers in the solver's place
        polish    the solver continues from the map's answers
        solver    as solve's
        """
        options = options_of(solver, published=True)
        check_map(map, polish, options)
        rows = steps_of(self, "steps", steps, times, commands)
        by = None if map is None else map._core
        return PathRun(self, remarked(_core.PathRun(self._core, by, polish, rows, options, optional(store))))

    @takes_old
    def follow(
        self,
        path: PathLike | ArrayLike | Mapping[str, ArrayLike],
        *,
        marker: str | None = None,
        times: ArrayLike | None = None,
        max_step_mm: float | None = None,
        start: Commands | None = None,
        workspace: PathLike | None = None,
        samples: int | None = None,
        store: PathLike | None = None,
        predict: bool = True,
        map: KinematicMap | None = None,
        polish: bool = False,
        method: str = "newton",
        tolerance_mm: float | None = None,
        descents: int = 30,
        solver: Solver | str = USUAL,
    ) -> FollowRun:
        """Moves markers along a path by inverse kinematics: an iterator of waypoints.

        path         (k, 3) places of one marker [mm]; by marker, (k, 3) of each; a column that is NaN does not count;
                     or a CSV file
        marker       whose places they are; None: the robot's only one
        times        (k,) [s], ascending
        max_step_mm  inserts waypoints so that no step is longer [mm]
        start        commands from which the first waypoint is sought; None: rest
        workspace    CSV of a workspace: the first waypoint is sought from its nearest sample
        method       'newton', 'gradient', or 'nearest': without inverse kinematics, each waypoint takes the commands of
                     the nearest sample, of `workspace` or of a grid of so many `samples` over the ranges, which is
                     solved for first
        store        folder as `softkin follow -o` writes it: a run that was stopped goes on where it was
        map, polish  as path's
        tolerance_mm  distance from a waypoint at which it is reached [mm]; None: 0.001, gradient 0.2
        descents, solver  as inverse's
        """
        statics = options_of(solver)
        check_map(map, polish, statics)
        nearest = method == "nearest"
        if nearest and (workspace is None) == (samples is None):
            raise InvalidInput("method 'nearest' takes the samples of one of workspace and samples")
        if samples is not None and not nearest:
            raise InvalidInput("samples are those of method 'nearest'")
        search = _core.InverseOptions("newton" if nearest else method, tolerance_mm, 200, descents, 3, statics)
        by = None if map is None else map._core
        begin = None if start is None else self._actuation(start, {})
        arguments = (search, predict, begin, optional(workspace), nearest, samples, optional(store))
        places, name = waypoints_of(self, path, marker, times, max_step_mm)
        return FollowRun(self, remarked(_core.FollowRun(self._core, by, polish, places, name, *arguments)))

    @takes_old
    def walk(
        self,
        gait: Steps,
        *,
        cycles: int = 3,
        times: ArrayLike | None = None,
        store: PathLike | None = None,
        solver: Solver | str = USUAL,
    ) -> WalkRun:
        """Walks on two feet with direction-dependent friction: an iterator of steps. docs/walking.md

        gait    one cycle of commands as path takes them, (k, m), by name, or a CSV file; its last row is its first
        cycles  how often it is walked, 1 to 100000
        times   (k,) [s], ascending; they go on from cycle to cycle
        store   folder of report.json, walk.csv, walk.svg and walk.pvd with the shapes: a walk that was stopped goes on
                where it was, or with more cycles
        solver  as solve's
        raises  InvalidInput where the robot has no feet, or is held or loaded along its direction of travel
        """
        if not 1 <= cycles <= 100_000:
            raise InvalidInput(f"cycles must be a whole number from 1 to 100000, not {cycles}")
        rows = steps_of(self, "gait", gait, times, {})
        return WalkRun(self, remarked(_core.WalkRun(self._core, rows, cycles, options_of(solver), optional(store))))

    @takes_old
    def grasp(
        self,
        closing: Steps | Commands | None = None,
        /,
        *,
        body: str | None = None,
        directions: str | Sequence[Direction] = AXES,
        most_N: float | None = None,
        solver: Solver | str = USUAL,
        progress: ProgressFunction | None = None,
        **commands: Command,
    ) -> Grasp:
        """Closes a gripper with the scene's bodies held, releases one, and pulls it until it slips. docs/contact.md

        closing     commands as `solve` takes them, (m,) or by name; or steps as `path` takes them, (k, m), by name for
                    each step, or a CSV file
        body        which one is released and pulled; None: the only one
        directions  of the pulls: 'x', '-x', 'y', '-y', 'z', '-z', or (x, y, z) of any length
        most_N      largest pull that is tried [N]
        progress    as solve's, of each solve; False ends the grasp with what there is
        commands    of actuators that closing does not name
        solver      as solve's
        returns     not being held is its `held`, not converging the status of a pull
        raises      InvalidInput where there is no such body
        """
        return Grasp(self, grasped(self, closing, commands, body, directions, most_N, options_of(solver), progress))

    @takes_old
    def workspace(
        self,
        samples: int,
        *,
        sampling: str = "grid",
        seed: int = 0,
        store: PathLike | None = None,
        progress: ProgressBar | None = None,
        solver: Solver | str = USUAL,
    ) -> Workspace:
        """The equilibria of many actuations inside the ranges of the actuators.

        samples   how many; a grid takes the nearest number that fills it
        sampling  'grid', 'sobol' or 'random'
        seed      of random samples
        store     CSV that grows meanwhile: a workspace that was stopped goes on where it was
        progress  such as tqdm: called with total=, then its update(n) is called
        solver    as solve's
        """
        threads = value_of(solver).threads
        return Workspace(self, sampled(self, samples, sampling, seed, store, progress, options_of(solver), threads))

    @takes_old
    def map(
        self,
        *,
        accuracy_mm: float = 0.01,
        load_accuracy: float | None = None,
        shape_accuracy_mm: float | None = 0.05,
        most: int = 2000,
        checks: int = 200,
        seed: int = 1,
        store: PathLike | None = None,
        progress: Callable[[MapProgress], Any] | None = None,
        solver: Solver | str = USUAL,
    ) -> KinematicMap:
        """The robot in closed form: its markers, loads and shape as polynomials of its commands.

        accuracy_mm        of markers [mm], at every check
        load_accuracy      of pressures [kPa] and tensions [N]; None: a thousandth of the largest
        shape_accuracy_mm  of every vertex [mm]; None: without the shape
        most               equilibria that each set of taut cables may take
        checks             random actuations at which the map is compared with the solver
        seed               of these
        store              where the map is to be, .skmap; what was found so far is kept beside it meanwhile: a map
                           that was stopped goes on where it was
        progress           called with a MapProgress at most 20 times a second; what it raises stops the work
        solver             as solve's
        returns            a map that misses the requested accuracy raises a SoftkinWarning: see `accurate`, `outputs`
        raises             InvalidInput on a robot that no map is made of: without markers, with friction
        """
        accuracies = (accuracy_mm, load_accuracy, shape_accuracy_mm)
        return made(self, *accuracies, most, checks, seed, store, progress, value_of(solver))

    def to_html(
        self,
        path: PathLike | None = None,
        /,
        shapes: Shape | Iterable[Shape] = (),
        *,
        map: KinematicMap | None = None,
    ) -> str:
        """A page of one file: the robot, with the shapes as steps to play.

        path     where it is written too, an .html; None: nowhere
        shapes   of this robot, in their order: one, a list, or a path that is still to be solved
        map      with the shape: on the page the robot is bent by sliders, and by dragging its markers
        raises   InvalidInput where shapes or map are of another robot, or this softkin was built without its page
        """
        return page(self, path, shapes, map)

    def view(
        self, shapes: Shape | Iterable[Shape] = (), *, map: KinematicMap | None = None, height: int = DEFAULT_HEIGHT
    ) -> PageView:
        """The same page in the cell of a notebook.

        height  of the frame [px]
        """
        return PageView(self.to_html(None, shapes, map=map), height)

    def __reduce__(self) -> tuple[Callable[[bytes], Robot], tuple[bytes]]:
        return _unpickled, (self._core.pickled(),)


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
    texts = (formulation_of(formulation), force_texts(forces), changes_of(changes))
    source = _core.Source.of_scene(os.fspath(scene), *texts)
    return Robot._of(_core.Robot(source, True))


def _unpickled(state: bytes) -> Robot:
    """Returns one robot for all pickles of it while it is referenced, so that unpickled shapes have the same robot."""
    key = hashlib.blake2b(state, digest_size=16).digest()
    robot = _unpickled_robots.get(key)
    if robot is None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SoftkinWarning)  # they were raised where it was made
            robot = Robot._of(_core.Robot(_core.Source.unpickled(state), False))
        _unpickled_robots[key] = robot
    return robot
