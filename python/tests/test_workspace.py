from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import softkin


class Bar:
    """What tqdm does."""

    last: Bar

    def __init__(self, *, total: int) -> None:
        self.total, self.done, self.closed = total, 0, False
        Bar.last = self

    def update(self, count: int) -> None:
        self.done += count

    def close(self) -> None:
        self.closed = True


def test_grid(robot: softkin.Robot) -> None:
    cloud = robot.workspace(8, progress=Bar)
    assert (Bar.last.total, Bar.last.done, Bar.last.closed) == (8, 8, True)
    assert len(cloud) == 8 and cloud.robot is robot and cloud.sampling == "grid of 2 x 2 x 2"
    assert cloud.actuation.shape == (8, 3) and cloud.places.shape == (8, 1, 3) and cloud["tip"].shape == (8, 3)
    assert (cloud.status == "converged").all()
    samples = cloud.samples
    assert samples.dtype.names[:7] == ("sample", "air1", "air2", "air3", "tip_x_mm", "tip_y_mm", "tip_z_mm")
    assert samples.dtype.names[7:] == (
        "air1_pressure_kPa",
        "air2_pressure_kPa",
        "air3_pressure_kPa",
        "status",
        "reached",
        "iterations",
    )
    np.testing.assert_array_equal(samples["tip_y_mm"], cloud["tip"][:, 1])
    assert samples["reached"].tolist() == [1] * 8
    again = pickle.loads(pickle.dumps(cloud))
    assert again.samples.tobytes() == samples.tobytes() and again.sampling == cloud.sampling
    hull = cloud.hull()
    summary = cloud.summary()
    assert again.summary() == summary and summary["seconds"] == cloud.seconds > 0
    assert [summary[key] for key in ("samples", "converged", "limit", "not_converged")] == [8, 8, 0, 0]
    assert summary["reach_mm"]["y"] == [cloud["tip"][:, 1].min(), cloud["tip"][:, 1].max()]
    assert summary["hull"]["volume_mm3"] == hull.volume_mm3
    assert hull.kind == "solid" and hull.volume_mm3 > 0 and hull.area_mm2 > 0
    assert hull.vertices.shape[1] == 3 and hull.triangles.shape[1] == 3 and len(hull.extents_mm) == 3
    assert "8 of 8 converged" in repr(cloud) and "<table>" in cloud._repr_html_()


def test_any_number_of_threads_gives_the_same(robot: softkin.Robot) -> None:
    one, two = (robot.workspace(12, sampling="sobol", solver=softkin.Solver(threads=n)) for n in (1, 2))
    assert one.samples.tobytes() == two.samples.tobytes()


def test_goes_on_where_it_was(robot: softkin.Robot, tmp_path: Path) -> None:
    whole = robot.workspace(12, sampling="random", seed=5, store=tmp_path / "w.csv")
    text = (tmp_path / "w.csv").read_text()
    lines = text.splitlines(keepends=True)
    (tmp_path / "w.csv").write_text("".join(lines[:-4]) + lines[-4][:10])
    again = robot.workspace(12, sampling="random", seed=5, store=tmp_path / "w.csv", progress=Bar)
    assert (tmp_path / "w.csv").read_text() == text and Bar.last.done == 12
    assert again.samples.tobytes() == whole.samples.tobytes()
    with pytest.raises(softkin.InvalidInput, match="w.csv: cannot go on with this workspace: its sampling is"):
        robot.workspace(12, sampling="random", seed=6, store=tmp_path / "w.csv")


def test_wrong_workspaces(robot: softkin.Robot, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="samples must be 1 or more, not 0"):
        robot.workspace(0)
    with pytest.raises(ValueError, match="sampling must be 'grid', 'sobol' or 'random', not 'gird'"):
        robot.workspace(8, sampling="gird")
    with pytest.raises(softkin.InvalidInput, match="no marker|marker"):
        robot.workspace(8).hull("tpi")


@pytest.mark.deep
def test_pandas(robot: softkin.Robot) -> None:
    pytest.importorskip("pandas", reason="pandas is not installed")
    cloud = robot.workspace(8)
    assert list(cloud.to_pandas().columns) == list(cloud.samples.dtype.names)
