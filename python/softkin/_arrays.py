"""Arrays of the user's as the library takes them: C order, checked, with an error that names the argument."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._core import InvalidInput
from ._kinds import shown

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]


def _shape_text(shape: tuple[int | None, ...]) -> str:
    names = iter("nkp")
    sizes = [str(size) if size is not None else next(names) for size in shape]
    return "(" + ", ".join(sizes) + ("," if len(sizes) == 1 else "") + ")"


def _checked(name: str, array: NDArray[Any], shape: tuple[int | None, ...]) -> None:
    fits = array.ndim == len(shape) and all(want in (None, has) for want, has in zip(shape, array.shape))
    if not fits:
        raise InvalidInput(f"{name} must have shape {_shape_text(shape)}, not {array.shape}")


def _no_number(values: object) -> object | None:
    """The first of what lists hold that numpy would take for a number without a word: a truth or a text."""
    if isinstance(values, (bool, np.bool_, str, bytes)):
        return values
    if isinstance(values, np.ndarray):
        return values.flat[0] if values.size and values.dtype.kind in "bSU" else None
    if isinstance(values, (list, tuple)):
        for each in values:
            if type(each) is not float and (found := _no_number(each)) is not None:
                return found
    return None


def dimensions(name: str, values: Any) -> int:
    """Of an array, or of what one is made of."""
    try:
        return int(np.ndim(values))
    except ValueError:
        raise InvalidInput(f"{name} must be an array: its rows differ in length") from None


def floats(name: str, values: ArrayLike, shape: tuple[int | None, ...], *, nan: bool = False) -> Floats:
    """Finite numbers of this shape (None: any size); nan: may some be unknown."""
    wanted = f"{name} must be an array of numbers of shape {_shape_text(shape)}"
    if (wrong := _no_number(values)) is not None:
        raise InvalidInput(f"{wanted}, but it holds {shown(wrong)}")
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidInput(f"{wanted}: {error}") from None
    if np.ndim(values) == 0:
        array = array.reshape(())
    _checked(name, array, shape)
    bad = np.isinf(array) if nan else ~np.isfinite(array)
    if bad.any():
        first = tuple(int(i) for i in np.argwhere(bad)[0])
        place = ", ".join(str(i) for i in first)
        raise InvalidInput(f"{name}[{place}] is {array[first]}; every value must be finite")
    return array


def indices(name: str, values: ArrayLike, shape: tuple[int | None, ...], below: int, of: str) -> Indices:
    """Whole numbers from 0 to below."""
    try:
        array = np.asarray(values)
    except (TypeError, ValueError, OverflowError) as error:
        raise InvalidInput(f"{name} must be an array of whole numbers of shape {_shape_text(shape)}: {error}") from None
    if array.size == 0:
        array = array.reshape(tuple(0 if size is None else size for size in shape)).astype(np.int32)
    _checked(name, array, shape)
    if array.dtype.kind not in "iu":
        raise InvalidInput(f"{name} must hold whole numbers, not {array.dtype}")
    wrong = (array < 0) | (array >= below)
    if wrong.any():
        first = array[wrong].flat[0]
        raise InvalidInput(f"{name} holds {first}, but there are {below} {of}, numbered from 0")
    return np.ascontiguousarray(array, dtype=np.int32)


def vector(name: str, values: ArrayLike) -> tuple[float, float, float]:
    """Three finite numbers."""
    if isinstance(values, (list, tuple)) and len(values) == 3 and _no_number(values) is None:  # no arrays are made
        try:
            x, y, z = (float(value) for value in values)
        except (TypeError, ValueError, OverflowError):
            pass  # refused below
        else:
            if math.isfinite(x) and math.isfinite(y) and math.isfinite(z):
                return x, y, z
    x, y, z = floats(name, values, (3,)).tolist()
    return x, y, z
