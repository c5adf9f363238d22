"""What arguments of public functions may be, by their types, and what is wrong with one, in one sentence."""

from __future__ import annotations

import builtins
import difflib
import functools
import math
import os
import sys
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from numbers import Integral, Real
from typing import Any, NamedTuple, ParamSpec, TypeVar

import numpy as np

from ._core import InvalidInput

__all__ = ["ANY", "FLOAT", "INT", "THREADS", "Kind", "Names", "kind_of", "named_file", "nearest", "number_of", "reading_of", "shown"]
__all__ += ["wrong"]

LARGEST_INT = 2**31 - 1
"""what the library counts with"""


class Kind(NamedTuple):
    """What an argument may be."""

    words: str
    """'a number'"""
    is_of: Callable[[Any], bool]
    """is a value of this kind, whatever it holds?"""
    fault: Callable[[str, Any], str | None]
    """what is wrong with a value of this kind: the whole sentence; None: nothing"""


def shown(value: object) -> str:
    """A value in a message, short and on one line."""
    if isinstance(value, np.ndarray) and value.ndim > 0:
        return f"an array of shape {value.shape}"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    if value is None or isinstance(value, (bool, int, float, str, bytes, np.generic)):
        try:
            text = repr(value.item() if isinstance(value, np.generic) else value)
        except ValueError:  # an integer of more digits than Python writes
            return "an integer of more than 4000 digits"
        return text if len(text) <= 60 else f"{text[:50]}... ({len(text)} characters)"
    return f"{'an' if type(value).__name__[0] in 'aeiouAEIOU' else 'a'} {type(value).__name__}"


def _no_fault(name: str, value: Any) -> str | None:
    return None


def _is_int(value: Any) -> bool:
    return isinstance(value, Integral) and not isinstance(value, (bool, np.bool_))


def _int_fault(name: str, value: Any) -> str | None:
    if -LARGEST_INT <= int(value) <= LARGEST_INT:
        return None
    return f"{name} must be a whole number of at most {LARGEST_INT} in size, not {shown(value)}"


def _is_float(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and value.dtype.kind in "iuf"
    return isinstance(value, Real) and not isinstance(value, (bool, np.bool_))


def _float_fault(name: str, value: Any) -> str | None:
    try:
        if math.isfinite(value):
            return None
    except OverflowError:
        return f"{name} is too large for a number of double precision: {shown(value)}"
    return f"{name} must be a finite number, not {shown(float(value))}"


def _is_path(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike)) and isinstance(os.fspath(value), str)


def _path_fault(name: str, value: Any) -> str | None:
    text = os.fspath(value)
    if not text:
        return f"{name} must name a file, not be empty"
    return f"{name} must name a file, not {shown(text)}" if "\0" in text or len(text) > 4000 else None


def _is_sequence(value: Any) -> bool:
    return isinstance(value, (Sequence, np.ndarray)) and not isinstance(value, (str, bytes))


def _is_truth(value: Any) -> bool:
    return isinstance(value, (bool, np.bool_))


INT = Kind("a whole number", _is_int, _int_fault)
FLOAT = Kind("a number", _is_float, _float_fault)
PLAIN: dict[Any, Kind] = {
    int: INT,
    float: FLOAT,
    bool: Kind("True or False", _is_truth, _no_fault),
    str: Kind("a text", lambda value: isinstance(value, str), _no_fault),
    type(None): Kind("None", lambda value: value is None, _no_fault),
}
MAX_THREADS = 1024


def _threads_fault(name: str, value: Any) -> str | None:
    if 0 <= int(value) <= MAX_THREADS:
        return None
    return f"{name} must be from 0 (as many as the machine has) to {MAX_THREADS}, not {shown(value)}"


THREADS = Kind("a whole number", _is_int, _threads_fault)
PATH = Kind("the name of a file", _is_path, _path_fault)
ANY = Kind("anything", lambda value: True, _no_fault)


class _Unknown(type):
    """A name that is imported for types alone, such as meshio."""

    def __getattr__(cls, name: str) -> type:
        return Unknown

    def __getitem__(cls, item: Any) -> type:
        return Unknown


class Unknown(metaclass=_Unknown):
    """The value is checked by the function itself."""


OWN_CHECKS: tuple[str, ...] = ("ArrayLike", "Command", "Commands", "Direction", "Floats", "Image", "Numbers", "Point", "Readings", "Steps")
OWN_CHECKS += ("SurfaceLike", "Target")
"""names of types whose values functions check themselves: arrays, and what is one of many things"""


class Names(dict[str, Any]):
    """Names in an annotation: of its module, of Python, or unknown."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(dict.fromkeys(OWN_CHECKS, Unknown))
        self._globals: dict[str, Any] = getattr(function, "__globals__", {})

    def __missing__(self, name: str) -> Any:
        if name in self._globals:
            return self._globals[name]
        found = getattr(builtins, name, None)  # else imported for types alone: of this package, or of another one
        return found if found is not None else getattr(sys.modules["softkin"], name, Unknown)


def _union(alternatives: Sequence[Any]) -> Kind:
    files = any(_is_path_type(each) for each in alternatives)
    kinds = [PATH] if files else []
    kinds += [kind_of(each) for each in alternatives if not files or not (each is str or _is_path_type(each))]
    if any(kind is ANY for kind in kinds):
        if type(None) in alternatives:
            return ANY
        return Kind("a value", lambda value: value is not None, _no_fault)

    def fault(name: str, value: Any) -> str | None:
        faults = [kind.fault(name, value) for kind in kinds if kind.is_of(value)]
        return None if None in faults else faults[0]

    words = [kind.words for kind in kinds]
    text = words[0] if len(words) == 1 else f"{', '.join(words[:-1])} or {words[-1]}"
    return Kind(text, lambda value: any(kind.is_of(value) for kind in kinds), fault)


def _is_path_type(annotation: Any) -> bool:
    return (typing.get_origin(annotation) or annotation) is os.PathLike


def _sequence_of(kind: Kind, length: int | None = None) -> Kind:
    def fault(name: str, value: Any) -> str | None:
        if length is not None and len(value) != length:
            return f"{name} must have {length} values, not {len(value)}"
        if isinstance(value, np.ndarray) and value.ndim != 1:
            return f"{name} must be a list, not {shown(value)}"
        return next((text for i, item in enumerate(value) if (text := wrong(kind, f"{name}[{i}]", item))), None)

    words = f"a list of {length} values" if length is not None else "a list"
    return Kind(words, _is_sequence, fault)


def _mapping_of(keys: Kind, values: Kind) -> Kind:
    def fault(name: str, value: Any) -> str | None:
        for key, item in value.items():
            if text := wrong(keys, f"a key of {name}", key) or wrong(values, f"{name}[{shown(key)}]", item):
                return text
        return None

    return Kind("a dictionary", lambda value: isinstance(value, Mapping), fault)


def _iterable_of(kind: Kind) -> Kind:
    """What may be read once is not read here."""
    inner = _sequence_of(kind)

    def fault(name: str, value: Any) -> str | None:
        return inner.fault(name, value) if isinstance(value, (list, tuple)) else None

    return Kind("a list", lambda value: isinstance(value, Iterable) and not isinstance(value, (str, bytes)), fault)


def _choice_of(choices: tuple[Any, ...]) -> Kind:
    words = " or ".join(map(repr, choices))
    return Kind(words, lambda value: isinstance(value, str) and value in choices, _no_fault)


@functools.lru_cache(maxsize=None)
def kind_of(annotation: Any) -> Kind:
    """What values of a type are."""
    if annotation is None:
        return PLAIN[type(None)]
    if annotation in PLAIN:
        return PLAIN[annotation]
    if annotation in (Unknown, Any, object) or isinstance(annotation, (TypeVar, ParamSpec)):
        return ANY
    origin, inner = typing.get_origin(annotation), typing.get_args(annotation)
    if origin in (types.UnionType, typing.Union):
        return _union(inner)
    if origin is typing.Literal:
        return _choice_of(inner)
    if _is_path_type(annotation):
        return PATH
    if origin is tuple and inner[-1:] != (Ellipsis,):
        return _tuple_of([kind_of(each) for each in inner])
    if origin in (list, tuple, Sequence):
        return _sequence_of(kind_of(inner[0]))
    if origin is Iterable:
        return _iterable_of(kind_of(inner[0]))
    if origin in (dict, Mapping):
        return _mapping_of(*(kind_of(each) for each in inner))
    if origin is Callable:
        return Kind("a function", callable, _no_fault)
    if getattr(annotation, "_is_protocol", False):
        return Kind("a function", callable, _no_fault) if "__call__" in vars(annotation) else ANY
    if isinstance(annotation, type):
        return Kind(f"a {_name_of(annotation)}", lambda value: isinstance(value, annotation), _no_fault)
    return ANY


def _tuple_of(kinds: Sequence[Kind]) -> Kind:
    count = len(kinds)

    def fault(name: str, value: Any) -> str | None:
        if len(value) != count:
            return f"{name} must have {count} values, not {len(value)}"
        faults = (wrong(kind, f"{name}[{i}]", item) for i, (kind, item) in enumerate(zip(kinds, value)))
        return next((text for text in faults if text), None)

    return Kind(f"a list of {count} values", _is_sequence, fault)


def _name_of(kind: type) -> str:
    name = "Robot" if kind.__name__ == "Compiled" else kind.__name__
    return f"softkin.{name}" if kind.__module__.partition(".")[0] == "softkin" else name


def number_of(name: str, value: Any) -> float:
    """A finite number, or InvalidInput."""
    if fault := wrong(FLOAT, name, value):
        raise InvalidInput(fault)
    return float(value)


def named_file(name: str, path: Any) -> str:
    """The name of a file, or InvalidInput."""
    if fault := wrong(PATH, name, path):
        raise InvalidInput(fault)
    return str(os.fspath(path))


def reading_of(name: str, value: Any) -> float:
    """A finite number, or NaN where it is None or NaN: what was not read."""
    if value is None or (isinstance(value, (float, np.floating)) and math.isnan(value)):
        return math.nan
    return number_of(name, value)


def wrong(kind: Kind, name: str, value: Any) -> str | None:
    """What is wrong with a value, a sentence; None: nothing."""
    if not kind.is_of(value):
        return f"{name} must be {kind.words}, not {shown(value)}"
    return kind.fault(name, value)


def nearest(name: str, names: Sequence[str]) -> str:
    """'; did you mean 'tolerance_mm'?', or which there are."""
    near = difflib.get_close_matches(name, names, 1, 0.6) or [each for each in names if each.startswith(name)][:1]
    if near:
        return f"; did you mean {near[0]!r}?"
    return f"; there are {', '.join(names)}" if names else "; it takes none by name"
