"""Options of the solver, and the progress that it reports."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Mapping
from dataclasses import asdict, astuple, dataclass, replace
from functools import lru_cache, wraps
from typing import Any, ClassVar, NamedTuple, ParamSpec, TypeVar

from . import _core
from ._core import InvalidInput
from ._kinds import number_of, shown
from ._warning import warn

__all__ = ["Progress", "Solver"]


def _pairs_of(options: Any) -> tuple[tuple[str, float], ...] | None:
    """Returns tuned constants as pairs of 'group.name' and value; None: all have their defaults."""
    if options is None:
        return None
    if isinstance(options, (str, os.PathLike)):
        return tuple(_core.read_solver_options(os.fspath(options))) or None
    pairs: list[tuple[str, float]] = []
    try:
        for group, values in options.items() if isinstance(options, Mapping) else options:
            named = values.items() if isinstance(values, Mapping) else [(None, values)]
            pairs += [(group if name is None else f"{group}.{name}", value) for name, value in named]
    except (TypeError, ValueError):
        raise InvalidInput(
            f"options must be a map of groups, such as {{'step': {{'max_turn': 20}}}}, or a file, not {shown(options)}"
        ) from None
    return tuple((str(name), number_of(f"the option {name}", value)) for name, value in pairs) or None


@dataclass(frozen=True)
class Solver:
    """Options of the solver: `solver=` of all calls that solve for equilibria."""

    method: str = "newton"
    """'newton', or for target shapes 'local-global': Algorithm 1 of Fang et al. 2020"""
    tolerance_mm: float | None = None
    """largest move of a vertex at which it stops [mm]; None: 8e-8 of the robot's size"""
    max_iterations: int | None = None
    """>= 1, of a shape; None: 500 of Newton's method, 50,000 of Algorithm 1"""
    anderson: int = 6
    """local-global: earlier steps that are combined, 0 to 20"""
    threads: int = 0
    """0: as many as the machine has and the robot is worth; of workspaces and maps equilibria solved at once, each on one
    thread; the result is the same"""
    stable: bool = False
    """physical: leave an unstable equilibrium along its lowest mode for a stable one"""
    as_published: bool = False
    """local-global, of `solve` and `path`: stop where the program of the paper's authors does, without acceleration: from
    the tenth iteration on when no marker moves by 0.032 mm; no equilibrium"""
    options: Any = None
    """other tuned constants, {'step': {'max_turn': 20}}, or the file of `--options`; a tuple of pairs once it is set"""
    _options: ClassVar[_core.SolveOptions]  # of each value, but no field

    def __post_init__(self) -> None:
        if self.tolerance_mm is not None and not self.tolerance_mm > 0:
            raise InvalidInput(f"the tolerance must be a length > 0 in mm, not {self.tolerance_mm}")
        object.__setattr__(self, "options", _pairs_of(self.options))
        made = _core.SolveOptions(
            self.method,
            self.tolerance_mm or 0.0,
            self.max_iterations,
            self.anderson,
            self.threads,
            self.stable,
            self.as_published,
            self.options or (),
        )
        object.__setattr__(self, "_options", made)

    def __repr__(self) -> str:
        """Shows the options that differ from the defaults."""
        settings = [f"{name}={value!r}" for name, value in asdict(self).items() if value != getattr(Solver, name)]
        return f"Solver({', '.join(settings)})"

    def __reduce__(self) -> tuple[type[Solver], tuple[Any, ...]]:
        return Solver, astuple(self)


USUAL = Solver()


class Progress(NamedTuple):
    """The progress of a running solve."""

    iteration: int
    step_mm: float
    """largest move of a vertex in the last iteration [mm]; of inverse kinematics the smallest error so far [mm]"""
    tolerance_mm: float
    """the step, or error, at which it stops [mm]"""
    share: float
    """completed fraction of the change to the requested commands [-]; < 0: not known"""


ProgressFunction = Callable[[Progress], object]


def progress_callback(progress: ProgressFunction) -> Callable[[int, float, float, float], bool]:
    def report(iteration: int, step_mm: float, tolerance_mm: float, fraction: float) -> bool:
        return progress(Progress(iteration, step_mm, tolerance_mm, fraction)) is not False

    return report


_named = lru_cache(maxsize=8)(Solver)


def value_of(solver: Solver | str) -> Solver:
    """A method's name stands for the method as usual."""
    if isinstance(solver, Solver):
        return solver
    if not isinstance(solver, str):
        raise InvalidInput(f"solver must be a softkin.Solver or a method's name, not {type(solver).__name__}")
    return _named(solver)


def options_of(
    solver: Solver | str,
    *,
    published: bool = False,
    elapsed_s: float | None = None,
    beyond: float | None = None,
    budget_s: float | None = None,
) -> _core.SolveOptions:
    """Returns the options of one call; published: does the call support as_published?"""
    options = (solver if type(solver) is Solver else value_of(solver))._options
    if options.as_published and not published:
        raise InvalidInput("as_published is for solve and path")
    if elapsed_s is None and beyond is None and budget_s is None:
        return options
    if beyond is not None and not beyond > 0:
        raise InvalidInput(f"beyond must be a volume or length > 0 over that at rest, not {beyond}")
    return options.of_call(elapsed_s, beyond, budget_s)


P = ParamSpec("P")
R = TypeVar("R")
OLD = frozenset(("tolerance_mm", "max_iterations", "anderson", "threads", "stable", "as_published"))
OLD_OF_SEARCH = OLD - {"tolerance_mm"} | {"step_tolerance_mm"}
"""where tolerance_mm is that of goals"""


def with_old(call: str, solver: Solver | str, names: frozenset[str], keywords: dict[str, Any]) -> Solver:
    """What Solver has now was a keyword each in 0.1: such are taken out of the keywords, with a warning."""
    old = sorted(names & keywords.keys())
    result = replace(value_of(solver), **{name.removeprefix("step_"): keywords.pop(name) for name in old})
    warn(
        f"{', '.join(f'{name}=' for name in old)} of {call} is deprecated and goes with softkin 0.2: write "
        f"solver=softkin.{result!r}",
        DeprecationWarning,
    )
    return result


def takes_old(function: Callable[P, R]) -> Callable[P, R]:
    """Takes old keywords, in 0.3 us, which solve and inverse spare a control loop."""
    names = OLD_OF_SEARCH if "tolerance_mm" in inspect.signature(function).parameters else OLD

    @wraps(function)
    def taking(*args: P.args, **keywords: P.kwargs) -> R:
        if not names.isdisjoint(keywords):
            given: dict[str, Any] = {**keywords}
            given["solver"] = with_old(function.__name__, given.get("solver", USUAL), names, given)
            return function(*args, **given)
        return function(*args, **keywords)

    setattr(taking, "_old_keywords", names)
    return taking
