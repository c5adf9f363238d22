"""Workspaces: the equilibria of many actuations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arrays import Floats, Indices
from ._compiled import Compiled
from ._core import InvalidInput
from ._files import PathLike, ending, optional
from ._of_robot import Found, parsed

if TYPE_CHECKING:
    import pandas

__all__ = ["Hull", "ProgressBar", "Workspace"]


class _Bar(Protocol):
    def update(self, n: int, /) -> object: ...

    def close(self) -> object: ...


class ProgressBar(Protocol):
    """What tqdm is."""

    def __call__(self, *, total: int) -> _Bar: ...


@dataclass(frozen=True)
class Hull:
    """Convex hull of the places of a marker."""

    kind: str
    """'solid', 'flat', 'line' or 'point'"""
    vertices: Floats
    """(v, 3) corners [mm]"""
    triangles: Indices
    """(t, 3) solid: its surface, normals outwards; flat: its area"""
    volume_mm3: float
    area_mm2: float
    """of the surface, or of one side where flat"""
    extents_mm: tuple[float, float, float]
    """along the principal axes of the places, descending"""


class Workspace(Found[_core.Workspace]):
    """Samples in their order, as a structured array: `samples`."""

    @property
    def sampling(self) -> str:
        """'grid of 15 x 15 x 15', 'sobol' or 'random, seed 7'."""
        return self._core.sampling

    @cached_property
    def actuation(self) -> Floats:
        """(s, m) commands: ratio [-], tension [N], pressure [kPa] or voltage [kV]."""
        return self._core.actuation

    @cached_property
    def places(self) -> Floats:
        """(s, p, 3) of the markers [mm]; NaN where there is no shape."""
        return self._core.markers.reshape(len(self), -1, 3)

    @cached_property
    def status(self) -> NDArray[np.str_]:
        """(s,) 'converged', 'limit' (values are those of the last good shape) or 'not_converged'."""
        return np.array(self._core.status)

    def __len__(self) -> int:
        return len(self._core.actuation)

    def __getitem__(self, marker: str) -> Floats:
        """(s, 3) places of a marker [mm]; NaN where there is no shape."""
        place: Floats = self.places[:, self._robot._core.marker(marker)]
        return place

    @cached_property
    def samples(self) -> NDArray[np.void]:
        """(s,) with the columns of the CSV that `softkin workspace` writes: sample, air_kPa, tip_x_mm, ..., status."""
        core = self._core
        actuators, markers, loads, loaded = core.columns
        fields: list[tuple[str, Any]] = [("sample", np.int64)]
        fields += [(name, np.float64) for name in [*actuators, *markers, *loads]]
        fields += [("status", self.status.dtype), ("reached", np.float64), ("iterations", np.int64)]
        table = np.zeros(len(self), dtype=fields)
        table["sample"] = np.arange(len(self))
        for names, values in (
            (actuators, self.actuation),
            (markers, core.markers),
            (loads, core.multipliers[:, loaded]),
        ):
            for name, column in zip(names, values.T):
                table[name] = column
        table["status"], table["reached"], table["iterations"] = self.status, core.reached, core.iterations
        return table

    def to_pandas(self) -> pandas.DataFrame:
        """The samples as a pandas.DataFrame."""
        import pandas

        return pandas.DataFrame({name: self.samples[name] for name in self.samples.dtype.names or ()})

    def hull(self, marker: str | None = None) -> Hull:
        """Of the samples that have an equilibrium; None: the robot's first marker."""
        kind, vertices, triangles, volume, area, (long, wide, thin) = self._core.hull(marker or "")
        return Hull(kind, vertices, triangles, volume, area, (long, wide, thin))

    @property
    def seconds(self) -> float:
        """That it took [s]."""
        return self._core.seconds

    def summary(self, marker: str | None = None) -> dict[str, Any]:
        """What `softkin workspace --json` prints: samples per status, reach and hull of a marker. None: the first."""
        return parsed(self._core.summary(marker or ""))

    def save(self, path: PathLike, marker: str | None = None) -> None:
        """The places of a marker for ParaView, with commands and loads: a .vtu. None: the robot's first marker."""
        self._core.save_cloud(ending("path", path, ".vtu"), marker or "")

    def save_hull(self, path: PathLike, marker: str | None = None) -> None:
        """The convex hull of a marker's places: a .stl or .vtu."""
        self._core.save_hull(ending("path", path, ".stl", ".vtu"), marker or "")

    def save_plot(self, path: PathLike, marker: str | None = None) -> None:
        """The places of a marker, seen along the axes: an .svg."""
        self._core.save_plot(ending("path", path, ".svg"), marker or "")

    def __repr__(self) -> str:
        good = int((self.status == "converged").sum())
        return f"<softkin.Workspace of {self._robot.name}: {self.sampling}; {good} of {len(self)} converged>"

    def _repr_html_(self) -> str:
        most = 10
        names = self.samples.dtype.names or ()
        head = "".join(f"<th>{escape(name)}</th>" for name in names)
        rows = "".join(
            "<tr>" + "".join(f"<td>{v:.6g}</td>" if isinstance(v, float) else f"<td>{v}</td>" for v in row) + "</tr>"
            for row in self.samples[:most].tolist()
        )
        return f"<p>{escape(repr(self)[1:-1])}</p><table><tr>{head}</tr>{rows}</table>"


def sampled(
    robot: Compiled,
    samples: int,
    sampling: str,
    seed: int,
    store: PathLike | None,
    progress: ProgressBar | None,
    options: _core.SolveOptions,
    threads: int,
) -> _core.Workspace:
    needed = 8.0 * samples * (2 * len(robot.actuators) + 3 * len(robot.markers) + 4)
    if needed > (free := _core.free_memory_bytes()):
        raise InvalidInput(
            f"samples: {samples} take about {_core.memory_text(needed)} of memory, and {_core.memory_text(free)} are free: "
            "take fewer"
        )
    bar: _Bar | None = None
    done = 0

    def begin(total: int) -> None:
        nonlocal bar
        if progress is not None:
            bar = progress(total=total)

    def kept(count: int) -> None:
        nonlocal done
        if bar is not None and count > done:
            bar.update(count - done)
            done = count

    try:
        return _core.workspace(robot._core, samples, sampling, seed, options, threads, optional(store), begin, kept)
    finally:
        if bar is not None:
            bar.close()
