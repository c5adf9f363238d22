"""Arguments of public functions: each is checked before work begins and refused in one sentence."""

from __future__ import annotations

import functools
import inspect
import sys
import types
from collections.abc import Callable, Iterable
from typing import Any, ParamSpec, TypeVar

from ._core import InvalidInput
from ._kinds import ANY, INT, THREADS, Kind, Names, kind_of, nearest, wrong

__all__ = ["InvalidCall", "checked", "guard"]

P = ParamSpec("P")
R = TypeVar("R")


class InvalidCall(InvalidInput, TypeError):
    """An argument that is missing, unknown, given twice or of a wrong type; also a TypeError, as Python's own is."""


class Plan:
    """How the arguments of a function are checked."""

    def __init__(self, function: Callable[..., Any], is_method: bool) -> None:
        inner = inspect.unwrap(function)
        self._call = function.__qualname__.removesuffix(".__init__").removesuffix(".__call__")
        names = Names(inner)
        self._positional: list[tuple[str, Kind | None]] = []
        self._required: list[tuple[str, int | None]] = []
        self._by_name: dict[str, Kind | None] = dict.fromkeys(getattr(function, "_old_keywords", ()), None)
        self._rest: Kind | None = None
        self._every: tuple[str, Kind] = ("", ANY)
        self._takes_rest = self._takes_all = False
        self._first = 1 if is_method else 0
        self._listed: list[str] = []
        for parameter in list(inspect.signature(inner).parameters.values())[self._first :]:
            self._add(parameter, names)

    def _add(self, parameter: inspect.Parameter, names: Names) -> None:
        annotation = parameter.annotation
        if isinstance(annotation, str):
            annotation = eval(annotation, {}, names)  # of this package's own source
        kind = ANY if annotation is inspect.Parameter.empty else kind_of(annotation)
        if parameter.name == "threads" and kind is INT:
            kind = THREADS
        check = None if kind is ANY else kind
        if parameter.kind is parameter.VAR_KEYWORD:
            self._rest, self._takes_rest = check, True
        elif parameter.kind is parameter.VAR_POSITIONAL:
            self._every, self._takes_all = (parameter.name, kind), True
        else:
            place = None if parameter.kind is parameter.KEYWORD_ONLY else len(self._positional)
            if place is not None:
                self._positional.append((parameter.name, check))
            if parameter.kind is not parameter.POSITIONAL_ONLY:
                self._by_name[parameter.name] = check
                self._listed.append(parameter.name)
            if parameter.default is parameter.empty:
                self._required.append((parameter.name, place))

    def check(self, given: tuple[Any, ...], keywords: dict[str, Any]) -> None:
        arguments = given[self._first :] if self._first else given
        if len(arguments) > len(self._positional) and not self._takes_all:
            raise InvalidCall(f"{self._call} takes {self._count()}, not {len(arguments)}")
        for (name, kind), value in zip(self._positional, arguments):
            if kind is not None:
                self._refuse(wrong(kind, name, value))
        for i, value in enumerate(arguments[len(self._positional) :]):
            self._refuse(wrong(self._every[1], f"{self._every[0]}[{i}]", value))
        if keywords:
            self._check_keywords(len(arguments), keywords)
        for name, place in self._required:
            if (place is None or place >= len(arguments)) and name not in keywords:
                raise InvalidCall(f"{self._call} needs {name}")

    def _check_keywords(self, count: int, keywords: dict[str, Any]) -> None:
        by_name = self._by_name
        for name, value in keywords.items():
            if name in by_name:
                kind = by_name[name]
            elif self._takes_rest:
                kind = self._rest
            else:
                raise InvalidCall(f"{self._call} has no argument {name!r}{nearest(name, self._listed)}")
            if kind is not None:
                self._refuse(wrong(kind, name, value))
        for name, _ in self._positional[:count]:
            if name in keywords and name in by_name:
                raise InvalidCall(f"{self._call}: {name} is given twice, by its place and by its name")

    def _count(self) -> str:
        count = len(self._positional)
        return f"{count or 'no'} argument{'' if count == 1 else 's'} without a name"

    @staticmethod
    def _refuse(fault: str | None) -> None:
        if fault is not None:
            raise InvalidCall(fault)


_MARK = "_is_checked"


def checked(function: Callable[P, R], *, is_method: bool = False) -> Callable[P, R]:
    """A function whose arguments are checked by their types; it raises InvalidInput before it is called."""
    plan: Plan | None = None

    @functools.wraps(function)
    def checking(*args: P.args, **keywords: P.kwargs) -> R:
        nonlocal plan
        if plan is None:  # types may be defined after the function
            plan = Plan(function, is_method)
        plan.check(args, keywords)
        return function(*args, **keywords)

    setattr(checking, _MARK, True)
    return checking


def _check_methods(kind: type[Any], constructor: bool) -> None:
    for name, member in list(vars(kind).items()):
        if name.startswith("_") and name not in ("__call__", "__getitem__") and not (constructor and name == "__init__"):
            continue
        if isinstance(member, classmethod):
            setattr(kind, name, classmethod(checked(member.__func__, is_method=True)))
        elif isinstance(member, staticmethod):
            setattr(kind, name, staticmethod(checked(member.__func__)))
        elif isinstance(member, types.FunctionType) and not hasattr(member, _MARK):
            setattr(kind, name, checked(member, is_method=True))


def guard(names: Iterable[str], module: types.ModuleType, constructed: Iterable[str] = ()) -> None:
    """Has the arguments of all public functions of a module checked, and those of the methods of its classes.

    names        of what is public; modules among them are guarded by themselves
    constructed  classes that users construct: the arguments of their constructors are checked, too
    """
    made = set(constructed)
    for name in names:
        member = getattr(module, name)
        if isinstance(member, type):
            for kind in member.__mro__:
                if kind.__module__.partition(".")[0] == "softkin" and kind.__module__ != "softkin._core":
                    _check_methods(kind, name in made)
        elif isinstance(member, types.FunctionType) and not hasattr(member, _MARK):
            function = checked(member)
            setattr(sys.modules[member.__module__], member.__name__, function)
            setattr(module, name, function)
