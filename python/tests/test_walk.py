from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beams import beam

import softkin

FEET = [{"marker": "heel", "forward": 0.02, "backward": 9}, {"marker": "toe", "forward": 0.02, "backward": 9}]
GAIT = [[1, 1, 1], [1.1, 1.1, 1.1], [1, 1, 1]]


def crawler(**changes: Any) -> softkin.Robot:
    """The beam on its two ends: its chambers push it forward."""
    description: dict[str, Any] = {
        "fixed": [{"region": "base"}, {"region": "end", "axes": "yz"}],
        "markers": {"heel": "base", "toe": "end"},
        "feet": FEET,
    }
    return beam(**{**description, **changes})


@pytest.fixture(scope="module")
def walker() -> softkin.Robot:
    return crawler()


def test_walk(walker: softkin.Robot, tmp_path: Path) -> None:
    run = walker.walk(GAIT, cycles=2, times=[0, 1, 2])
    assert isinstance(run, softkin.WalkRun) and len(run) == 5 and run.done == 0
    assert np.allclose(run.direction, [1, 0, 0], atol=1e-9) and run.strides_mm.shape == (0,)
    with pytest.raises(ValueError, match="nothing to plot"):
        run.save_plot(tmp_path / "walk.svg")
    first = next(run)
    assert isinstance(first, softkin.WalkStep)
    assert (first.number, first.cycle, first.sliding, first.travel_mm, first.status) == (0, 0, "none", 0, "converged")
    steps = [first, *run]
    assert [step.cycle for step in steps] == [0, 1, 1, 2, 2] and [step.time_s for step in steps] == [0, 1, 2, 3, 4]
    assert [step.number for step in steps] == list(range(5)) and all(step.equilibria > 0 for step in steps)
    assert [step.sliding for step in steps[1:]] == ["front", "rear"] * 2  # longer: the toe goes on; shorter: the heel
    travels = [step.travel_mm for step in steps]
    assert travels == sorted(travels) and travels[-1] > 0.3
    assert steps[1].friction_N == pytest.approx(-0.02) and steps[2].friction_N == pytest.approx(0.02)
    assert steps[-1].feet_mm["toe"] - steps[-1].feet_mm["heel"] == pytest.approx(64, abs=0.1)
    moved = steps[-1].shape["heel"] - first.shape["heel"]
    assert moved[0] == pytest.approx(steps[-1].feet_mm["heel"] - first.feet_mm["heel"], abs=1e-6)
    assert run.strides_mm.shape == (2,) and run.strides_mm.sum() == pytest.approx(travels[-1])
    assert run.report["stride_mm"] == run.strides_mm.tolist() and run.report["steps"][4] == steps[4].step
    assert run.steps["travel_mm"].tolist() == travels and "5 of 5 steps" in repr(run)
    run.save_plot(tmp_path / "walk.svg")
    assert "<svg" in (tmp_path / "walk.svg").read_text()


def test_walk_goes_on_and_further(walker: softkin.Robot, tmp_path: Path) -> None:
    whole = [step.shape.fingerprint for step in walker.walk(GAIT, cycles=2)]
    for step in walker.walk(GAIT, cycles=1, store=tmp_path / "out"):
        if step.number == 1:
            break
    run = walker.walk(GAIT, cycles=1, store=tmp_path / "out")
    assert run.done == 2
    assert [step.shape.fingerprint for step in run] == whole[2:3]
    further = walker.walk(GAIT, cycles=2, store=tmp_path / "out")
    assert further.done == 3 and [step.shape.fingerprint for step in further] == whole[3:]
    report = json.loads((tmp_path / "out/report.json").read_text())
    assert [step["shape_fingerprint"] for step in report["steps"]] == whole and len(report["stride_mm"]) == 2
    assert sorted(file.name for file in (tmp_path / "out").iterdir() if file.suffix != ".vtu") == [
        "report.json",
        "walk.csv",
        "walk.pvd",
        "walk.svg",
    ]
    with pytest.raises(softkin.InvalidInput, match="the gait has changed"):
        walker.walk([[1, 1, 1], [1.2, 1.1, 1.1], [1, 1, 1]], store=tmp_path / "out")


def test_a_step_without_an_equilibrium_is_the_last(walker: softkin.Robot) -> None:
    run = walker.walk(GAIT, solver=softkin.Solver(tolerance_mm=1e-30, max_iterations=3))
    steps = list(run)
    assert [step.status for step in steps] == ["converged", "not converged"] and run.done == 1
    with pytest.raises(softkin.NotConverged):
        steps[1].shape.require()
    with pytest.warns(DeprecationWarning, match="max_iterations=, tolerance_mm= of walk is deprecated"):
        again = walker.walk(GAIT, tolerance_mm=1e-30, max_iterations=3)
    assert [step.status for step in again] == ["converged", "not converged"]
    assert len(run.report["steps"]) == 1


def test_target_shapes_know_no_friction() -> None:
    robot = crawler(formulation="target-shape", materials=[{"shape_ratio": 1.0}])
    assert all(step.friction_N is None for step in robot.walk(GAIT, cycles=1))


def test_wrong_walks(robot: softkin.Robot, walker: softkin.Robot, tmp_path: Path) -> None:
    with pytest.raises(softkin.InvalidInput, match="no feet to walk on"):
        robot.walk(GAIT)
    with pytest.raises(softkin.InvalidInput, match="the gait: a gait ends where it begins, but air1 ends at"):
        walker.walk([[1, 1, 1], [1.1, 1, 1]])
    with pytest.raises(ValueError, match="cycles must be a whole number from 1 to 100000, not 0"):
        walker.walk(GAIT, cycles=0)
    with pytest.raises(ValueError, match=r"gait must have shape \(n, 3\), not \(3,\)"):
        walker.walk([1, 1, 1])
    with pytest.raises(ValueError, match="times: a file has its own"):
        walker.walk(tmp_path / "gait.csv", times=[0, 1])
    with pytest.raises(softkin.InvalidInput, match="gait.csv"):
        walker.walk(tmp_path / "gait.csv")
