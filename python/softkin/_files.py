"""Names of files."""

from __future__ import annotations

import os
from collections.abc import Sequence

PathLike = str | os.PathLike[str]


def listed(files: PathLike | Sequence[PathLike]) -> list[str]:
    """One file or several."""
    return [os.fspath(file) for file in ([files] if isinstance(files, (str, os.PathLike)) else files)]


def optional(path: PathLike | None) -> str:
    """'' for none."""
    return "" if path is None else os.fspath(path)


def ending(name: str, path: PathLike, *endings: str) -> str:
    """The file, whose name ends as it must."""
    file = os.fspath(path)
    if not file.lower().endswith(endings):
        raise ValueError(f"{name} must end in {' or '.join(endings)}, not {os.path.basename(file)!r}")
    return file
