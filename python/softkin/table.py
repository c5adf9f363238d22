"""Tables as the command prints and writes them."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from . import _core
from ._arrays import Floats
from ._core import InvalidInput
from ._kinds import nearest

if TYPE_CHECKING:
    import pandas

__all__ = ["Table"]

Cell = float | int | str | None


class Table:
    """Columns by key, each with its unit in the key."""

    def __init__(self, core: _core.Table) -> None:
        self._core = core

    @property
    def columns(self) -> list[str]:
        """Keys, with units: 'tip_x_mm'."""
        return self._core.keys

    @property
    def rows(self) -> list[list[Cell]]:
        """None: not known, or does not apply."""
        return self._core.rows

    def __len__(self) -> int:
        return len(self._core.rows)

    def __getitem__(self, column: str) -> Floats:
        """A column of numbers; NaN where there is none."""
        if column not in self.columns:
            raise InvalidInput(f"there is no column {column!r}{nearest(column, self.columns)}")
        place = self.columns.index(column)
        values = [row[place] for row in self.rows]
        return np.array([np.nan if value is None else float(value) for value in values])

    def csv(self) -> str:
        """As the content of a CSV file."""
        return self._core.csv()

    def to_pandas(self) -> pandas.DataFrame:
        import pandas

        return pandas.DataFrame(self.rows, columns=self.columns)

    def __repr__(self) -> str:
        return self._core.text().rstrip("\n")

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{escape(title)}</th>" for title in self._core.titles)
        body = "".join("<tr>" + "".join(f"<td>{_text(cell)}</td>" for cell in row) + "</tr>" for row in self.rows)
        return f"<table><tr>{head}</tr>{body}</table>"


def _text(cell: Cell) -> str:
    if cell is None:
        return ""
    return f"{cell:.6g}" if isinstance(cell, float) else escape(str(cell))
