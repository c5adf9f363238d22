"""Files and pictures of shapes."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import TypeVar

from ._arrays import vector
from ._core import Answer as CoreAnswer
from ._core import Shape as CoreShape
from ._core import InvalidInput
from ._files import PathLike, write
from ._of_robot import Found

View = tuple[float, float, float]


Core = TypeVar("Core", CoreShape, CoreAnswer)


class Saving(Found[Core]):
    """What has a picture, a report and a shape."""

    @abstractmethod
    def _core_shape(self) -> CoreShape: ...

    @abstractmethod
    def _title(self) -> str: ...

    def save(self, path: PathLike, *, view: View | None = None) -> None:
        """Writes the shape as .vtu (ParaView), a picture as .png, or the report as .json.

        view  of a picture: from the robot to the eye
        """
        file = Path(path)
        ending = file.suffix.lower()
        if ending == ".vtu":
            self._core_shape().save_vtu(str(file))
        elif ending == ".png":
            write(file, self.png(view))
        elif ending == ".json":
            write(file, self._core.report())
        else:
            raise InvalidInput(f"path must end in .vtu, .png or .json, not {file.name!r}")

    def png(self, view: View | None = None) -> bytes:
        """A picture, coloured by displacement, with crosses at the targets of an answer: the content of a PNG file."""
        direction = [] if view is None else list(vector("view", view))
        if direction and not any(direction):
            raise InvalidInput("view must be a direction, so not zero")
        return self._core.png(direction, self._title())

    def _repr_png_(self) -> bytes:
        return self.png()
