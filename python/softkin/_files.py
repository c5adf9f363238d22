"""Names of files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from ._core import InvalidInput

PathLike = str | os.PathLike[str]


def listed(files: PathLike | Sequence[PathLike]) -> list[str]:
    """One file or several."""
    return [os.fspath(file) for file in ([files] if isinstance(files, (str, os.PathLike)) else files)]


def optional(path: PathLike | None) -> str:
    """'' for none."""
    return "" if path is None else os.fspath(path)


def write(path: PathLike, content: str | bytes, newline: str | None = None) -> None:
    """Writes a file, or raises InvalidInput where its folder is not there or cannot be written to."""
    try:
        if isinstance(content, bytes):
            Path(path).write_bytes(content)
        else:
            Path(path).write_text(content, encoding="utf-8", newline=newline)
    except OSError as error:
        raise InvalidInput(f"{os.fspath(path)}: cannot be written: {error.strerror}") from None


def ending(name: str, path: PathLike, *endings: str) -> str:
    """The file, whose name ends as it must."""
    file = os.fspath(path)
    if not file.lower().endswith(endings):
        raise InvalidInput(f"{name} must end in {' or '.join(endings)}, not {os.path.basename(file)!r}")
    return file
