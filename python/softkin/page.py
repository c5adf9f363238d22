"""Pages that show a robot in a browser: one file each, without a server or network. docs/page.md"""

from __future__ import annotations

import os
from collections.abc import Iterable
from html import escape
from pathlib import Path

from . import _core
from ._compiled import Compiled
from ._core import InvalidInput
from ._files import PathLike, write
from .maps import KinematicMap
from .shape import Shape

__all__ = ["PageView"]

DEFAULT_HEIGHT = 640  # [px]


class PageView:
    """A page in the cell of a notebook."""

    def __init__(self, html: str, height: int) -> None:
        self.html = html
        """of the page"""
        self.height = height
        """of the frame [px]"""

    def _repr_html_(self) -> str:
        return (
            f'<iframe srcdoc="{escape(self.html)}" width="100%" height="{self.height}" style="border:0" '
            'sandbox="allow-scripts allow-downloads" title="softkin"></iframe>'
        )

    def __repr__(self) -> str:
        return f"<softkin.PageView: {len(self.html) / 1e6:.1f} MB, for a notebook>"


def page(robot: Compiled, path: PathLike | None, shapes: Shape | Iterable[Shape], map: KinematicMap | None) -> str:
    if path is not None and Path(path).suffix != ".html":
        raise InvalidInput(f"{os.fspath(path)}: must end in .html")
    listed = [shapes] if isinstance(shapes, Shape) else list(shapes)
    for shape in listed:
        if not isinstance(shape, Shape):
            raise InvalidInput(f"shapes must be of type Shape, not {type(shape).__name__}")
    cores = [shape._core for shape in listed]
    html = _core.page(robot._core, cores, None if map is None else map._core, "Python: robot.to_html()")
    if path is not None:
        write(path, html, newline="\n")
    return html
