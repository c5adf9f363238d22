"""Pages that show a robot in a browser: one file each, without a server or network. docs/page.md"""

from __future__ import annotations

import os
from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from . import _core
from .shape import Shape

if TYPE_CHECKING:
    from .maps import KinematicMap
    from .robot import Robot

__all__ = ["PageView"]

DEFAULT_HEIGHT = 640


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


class _Pages:
    """What a robot has of pages."""

    _core: _core.Robot

    def to_html(
        self,
        path: str | os.PathLike[str] | None = None,
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
        if path is not None and Path(path).suffix != ".html":
            raise ValueError(f"{os.fspath(path)}: must end in .html")
        listed = [shapes] if isinstance(shapes, Shape) else list(shapes)
        for shape in listed:
            if not isinstance(shape, Shape):
                raise TypeError(f"shapes must be of type Shape, not {type(shape).__name__}")
        html = _core.page(
            self._core,
            [shape._core_shape() for shape in listed],
            None if map is None else map._core,
            "Python: robot.to_html()",
        )
        if path is not None:
            Path(path).write_text(html, encoding="utf-8", newline="\n")
        return html

    def view(
        self, shapes: Shape | Iterable[Shape] = (), *, map: KinematicMap | None = None, height: int = DEFAULT_HEIGHT
    ) -> PageView:
        """The same page in the cell of a notebook.

        height  of the frame [px]
        """
        return PageView(self.to_html(None, shapes, map=map), height)
